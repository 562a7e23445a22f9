// Prints the time samples and the topology of every mesh of a USDA file, read by three.js, as JSON.
//   node read_usda.mjs FILE
import { readFileSync } from 'node:fs';
import * as THREE from 'three';
import { USDAParser } from 'three/addons/loaders/usd/USDAParser.js';
import { USDLoader } from 'three/addons/loaders/USDLoader.js';

const text = readFileSync(process.argv[2], 'utf8');
const { specsByPath } = new USDAParser().parseData(text);

const meshes = [];
for (const [path, spec] of Object.entries(specsByPath)) {
  if (spec.fields.typeName !== 'Mesh') continue;
  const field = (name) => specsByPath[`${path}.${name}`].fields;
  meshes.push({
    path,
    times: field('points').timeSamples.times,
    points: field('points').timeSamples.values,
    counts: field('faceVertexCounts').default,
    indices: field('faceVertexIndices').default,
  });
}

let loaded = 0;
new USDLoader().parse(text).traverse((object) => { if (object.isMesh) loaded += 1; });
console.log(JSON.stringify({ revision: THREE.REVISION, meshes, loaded }));
