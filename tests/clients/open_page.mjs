// Opens a page of this machine in Chromium and prints what went wrong and what is on it, as JSON.
//   node open_page.mjs '{"chromium": PROGRAM, "page": FILE, "picture": PNG}'
import { dirname } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const settings = JSON.parse(process.argv[2]);
const home = pathToFileURL(dirname(settings.page)).href + '/';
// A page of ours may show itself, what it carries in itself, and what lies in its folder.
const isOurs = (url) => url.startsWith('data:') || url.startsWith('blob:') || url.startsWith(home);

const browser = await chromium.launch({
  executablePath: settings.chromium,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
const errors = [], outside = [], failed = [];
page.on('pageerror', (error) => errors.push(String(error)));
page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
page.on('request', (request) => { if (!isOurs(request.url())) outside.push(request.url().slice(0, 200)); });
page.on('requestfailed', (request) => failed.push(request.url().slice(0, 200)));
await page.route((url) => !isOurs(url.href), (route) => route.abort());
await page.goto(pathToFileURL(settings.page).href, { waitUntil: 'load' });

// Sliders and folded parts are used as a reader would.
await page.evaluate(() => {
  for (const fold of document.querySelectorAll('details')) fold.open = true;
  for (const image of document.images) image.loading = 'eager';
  for (const slider of document.querySelectorAll('input[type=range]')) {
    slider.value = String((Number(slider.min || 0) + Number(slider.max || 100)) / 3);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    slider.dispatchEvent(new Event('change', { bubbles: true }));
  }
});
const seen = await page.evaluate(async () => {
  const images = [...document.images];
  const broken = [];
  for (const image of images) {
    try {
      await image.decode();
    } catch (error) {
      broken.push(`${image.alt || image.src.slice(0, 80)}: ${error}`);
    }
  }
  return {
    title: document.title,
    images: images.length + document.querySelectorAll('svg').length,
    broken,
    letters: document.body.innerText.trim().length,
    width: document.documentElement.scrollWidth,
    room: document.documentElement.clientWidth,
  };
});
await page.screenshot({ path: settings.picture, fullPage: true });
const name = `Chromium ${browser.version()}`;
await browser.close();
console.log(JSON.stringify({ browser: name, errors, outside, failed, ...seen }));
