// How the datasheet looks: A4 upright, black on white, also without colours.
#pragma once

namespace armwright {

inline constexpr const char* kDatasheetStyle = R"(
@page { size: A4; margin: 11mm 12mm; }
* { box-sizing: border-box; }
body { margin: 0 auto; width: 186mm; font: 8.2pt/1.3 "DejaVu Sans", Arial, sans-serif; color: #111; background: #fff; }
h1 { font-size: 14pt; margin: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
h2 { font-size: 9pt; margin: 2.2mm 0 .6mm; border-bottom: .3mm solid #111; }
p { margin: .5mm 0; }
.lead, .clamped { display: -webkit-box; -webkit-box-orient: vertical; -webkit-line-clamp: 2; overflow: hidden; }
.columns { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 0 5mm; }
.figures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 5mm; }
dl { display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: 0 2mm; margin: 0; }
dt { color: #444; }
dd { margin: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
table { width: 100%; border-collapse: collapse; table-layout: fixed; font-size: 7.6pt; }
th, td { padding: .25mm .8mm; border-bottom: .1mm solid #bbb; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
th { font-weight: normal; color: #444; text-align: left; }
tr:first-child th { font-size: 7pt; font-weight: bold; color: #111; border-bottom: .2mm solid #111; text-align: right; }
tr:first-child th:first-child { text-align: left; }
th:first-child { width: 34mm; }
td { text-align: right; font-variant-numeric: tabular-nums; }
td.green { background: #d3ecd3; }
td.yellow { background: #fbedb4; }
td.red { background: #f6c9c4; }
td.grey { background: #e6e6e6; }
svg { width: 100%; display: block; font-size: 9px; }
svg .grid { stroke: #ddd; stroke-width: .5; }
svg polyline { fill: none; stroke: #14508c; stroke-width: 1.2; }
.small { font-size: 6.4pt; overflow-wrap: anywhere; }
)";

}  // namespace armwright
