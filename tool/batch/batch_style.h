/// The style sheet of a batch's page.
#pragma once

namespace softreel {

/// Colours are variables, so that dark, light and paper differ in one place each.
inline constexpr const char* kBatchStyle = R"css(
:root { color-scheme: light dark; --back: #fbfbfa; --panel: #f1f1ef; --line: #d9d9d4; --text: #1c1d20; --faint: #5f626a;
  --good: #2f7d4b; --bad: #b3361c; --idle: #6b6e76; --bad-back: #fbe9e4; --bar: #7a93b8;
  --total: #1c1d20; --kinetic: #b8571a; --elastic: #1f6fb5; --gravity: #3a8a4d; }
@media (prefers-color-scheme: dark) {
  :root { --back: #17181b; --panel: #202226; --line: #363940; --text: #dddee1; --faint: #a0a3ab; --good: #7fc98f;
    --bad: #ff9474; --idle: #a0a3ab; --bad-back: #35211d; --bar: #5b7397;
    --total: #e8e9ec; --kinetic: #f0a35e; --elastic: #74b4f0; --gravity: #86cf96; } }
* { box-sizing: border-box; }
body { background: var(--back); color: var(--text); font: 15px/1.5 system-ui, sans-serif; max-width: 1120px;
  margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.6em; font-weight: 600; margin: 0 0 .2em; }
h2 { font-size: 1.15em; font-weight: 600; margin: 0; overflow-wrap: anywhere; }
h2 .faint { font-weight: 400; font-size: .85em; }
h3 { font-size: .85em; font-weight: 600; color: var(--faint); margin: 1em 0 .3em; }
p { margin: .3em 0; } .faint { color: var(--faint); } a { color: inherit; }
pre { background: var(--panel); border-radius: 4px; padding: .6em .8em; margin: .5em 0; white-space: pre-wrap;
  overflow-wrap: anywhere; font: 13px/1.45 ui-monospace, monospace; }
pre.bad { background: var(--bad-back); border-left: 3px solid var(--bad); }
.state { font-weight: 600; white-space: nowrap; } .good { color: var(--good); } .bad { color: var(--bad); }
pre.bad { color: var(--text); } .idle { color: var(--idle); }
.failures { background: var(--bad-back); border-left: 3px solid var(--bad); margin: .8em 0; padding: .5em .8em .5em 1.6em;
  border-radius: 4px; overflow-wrap: anywhere; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(200px, 1fr)); gap: 14px; margin: 1.4em 0; }
.card { text-decoration: none; background: var(--panel); border-radius: 6px; overflow: hidden; border: 1px solid
  var(--line); display: flex; flex-direction: column; }
.card.failed { border-color: var(--bad); }
.card img { width: 100%; display: block; } .card .none { aspect-ratio: 16 / 9; display: grid; place-items: center;
  color: var(--faint); background: var(--back); }
.card div.words { padding: .5em .7em .6em; font-size: .9em; overflow-wrap: anywhere; line-height: 1.35; }
table { border-collapse: collapse; width: 100%; font-size: .93em; }
td, th { text-align: left; padding: .3em .9em .3em 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; color: var(--faint); } td.number, th.number { text-align: right; white-space: nowrap; }
td:first-child { overflow-wrap: anywhere; }
section { border-top: 1px solid var(--line); margin-top: 2em; padding-top: 1.2em; }
.head { display: flex; gap: 1em; align-items: baseline; justify-content: space-between; flex-wrap: wrap; }
.sheet { width: 100%; display: block; border-radius: 4px; margin: .7em 0; }
.pair { display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 0 2em; }
@media (max-width: 760px) { .pair { grid-template-columns: minmax(0, 1fr); } }
.plot { width: 100%; height: auto; display: block; }
.plot-line { fill: none; stroke-width: 1.6; } .plot-axis { stroke: var(--line); stroke-width: 1; }
.plot-text { fill: var(--faint); font-size: 11px; } .plot-name { font-size: 12px; }
polyline.plot-total { stroke: var(--total); stroke-width: 1.2; stroke-dasharray: 5 3; }
polyline.plot-kinetic { stroke: var(--kinetic); } polyline.plot-elastic { stroke: var(--elastic); }
polyline.plot-gravity { stroke: var(--gravity); } text.plot-total { fill: var(--total); }
text.plot-kinetic { fill: var(--kinetic); } text.plot-elastic { fill: var(--elastic); }
text.plot-gravity { fill: var(--gravity); }
.stages { display: grid; grid-template-columns: max-content 1fr max-content; gap: .25em .8em; align-items: center;
  font-size: .9em; }
.stages .bar { height: .75em; border-radius: 2px; background: var(--bar); min-width: 1px; }
.stages .number { text-align: right; } ul { margin: .3em 0; padding-left: 1.2em; }
@media print {
  :root { color-scheme: light; --back: #fff; --panel: #f4f4f4; --line: #bbb; --text: #000; --faint: #444;
    --good: #1d6236; --bad: #a02a10; --idle: #444; --bad-back: #f7ece8; --bar: #8a9bb5; --total: #000;
    --kinetic: #a34a10; --elastic: #155a99; --gravity: #2c7a3f; }
  body { max-width: none; margin: 0; font-size: 10pt; } section { break-inside: avoid; } .card { break-inside: avoid; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  .cards { grid-template-columns: repeat(4, 1fr); } }
)css";

}  // namespace softreel
