// The style of report.html: one column, system fonts, light and dark by the reader's setting, prints well.
#pragma once

#include <string>

namespace imbibe {

inline const std::string report_style = R"css(
:root {
  color-scheme: light dark;
  --page: #fbfbfa; --card: #ffffff; --ink: #1c1f23; --soft: #5d646d; --line: #e3e5e8; --good: #17774f; --bad: #b3341f;
  --curve-1: #2a78d6; --curve-2: #eb6834; --curve-3: #1a9d70; --curve-4: #c98900; --curve-5: #d55181; --curve-6: #5a4bb8;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #16181b; --card: #1e2125; --ink: #e8eaed; --soft: #9aa2ac; --line: #33383e; --good: #55c795; --bad: #f08a73;
    --curve-1: #5a9fee; --curve-2: #ef8355; --curve-3: #3cbd8f; --curve-4: #dba73a; --curve-5: #e57ba0; --curve-6: #a196f0;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 32px 20px 64px; }
h1 { font-size: 28px; line-height: 1.2; margin: 0 0 6px; font-weight: 650; }
h2 { font-size: 18px; margin: 40px 0 12px; font-weight: 650; }
h3 { font-size: 15px; margin: 16px 0 6px; font-weight: 600; }
a { color: var(--curve-1); }
.kind { margin: 0 0 4px; color: var(--soft); font-size: 13px; }
.status { margin: 0 0 20px; color: var(--soft); }
.status.done { color: var(--good); }
.status.failed, .status.interrupted { color: var(--bad); }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: 12px; margin: 0; }
.tile { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px 14px; }
.tile dt { color: var(--soft); font-size: 13px; }
.tile dd { margin: 2px 0 0; font-size: 20px; font-weight: 600; font-variant-numeric: tabular-nums; }
.tile p { margin: 2px 0 0; color: var(--soft); font-size: 12px; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(460px, 100%), 1fr)); gap: 16px; }
.chart { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 14px 14px 8px; }
.chart figcaption { font-weight: 600; }
.plot { display: block; width: 100%; height: auto; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: 2px 16px; margin: 4px 0 8px; padding: 0; font-size: 13px;
  color: var(--soft); }
.legend b { color: var(--ink); font-weight: 600; font-variant-numeric: tabular-nums; }
.swatch { width: 22px; height: 8px; margin-right: 6px; vertical-align: middle; }
.curve { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.c1 { stroke: var(--curve-1); } .c2 { stroke: var(--curve-2); } .c3 { stroke: var(--curve-3); }
.c4 { stroke: var(--curve-4); stroke-dasharray: 7 4; } .c5 { stroke: var(--curve-5); stroke-dasharray: 2 4; }
.c6 { stroke: var(--curve-6); stroke-dasharray: 9 3 2 3; }
.grid { stroke: var(--line); stroke-width: 1; }
.axis { stroke: var(--soft); stroke-width: 1; }
.limit { stroke: var(--bad); stroke-width: 1.5; stroke-dasharray: 6 4; }
.tick { fill: var(--soft); font-size: 12px; font-variant-numeric: tabular-nums; }
.name { fill: var(--soft); font-size: 13px; }
.nothing { color: var(--soft); }
.hero, video { width: 100%; border-radius: 8px; border: 1px solid var(--line); display: block; background: var(--card); }
.strip { display: grid; grid-template-columns: repeat(auto-fill, minmax(160px, 1fr)); gap: 10px; margin-top: 10px; }
.strip img { width: 100%; border-radius: 6px; border: 1px solid var(--line); display: block; }
pre { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px 14px; overflow-x: auto;
  font: 13px/1.5 ui-monospace, monospace; margin: 0; }
pre.command { white-space: pre-wrap; word-break: break-word; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 400; color: var(--soft); padding: 4px 24px 4px 0; vertical-align: top; }
td { padding: 4px 0; }
tr + tr { border-top: 1px solid var(--line); }
@media print { body { background: #fff; } .tile, .chart, pre { break-inside: avoid; } }
)css";

}  // namespace imbibe
