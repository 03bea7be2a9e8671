// The colours and fonts of the figures. The series colours are those of Okabe and Ito (2008), which
// colour-blind readers can distinguish; yellow is darker on white. After eight series, dashes and
// symbols change too.
export interface Look {
  theme: 'light' | 'dark';
  background: string;
  text: string;
  muted: string; // names of axes, captions
  grid: string;
  accent: string;
  bad: string; // failures, limits
  series: string[];
  font: string;
}

// The names have no quotes, because ECharts writes them unchanged into attributes of its SVG. CSS
// does not need quotes here.
const kFont = 'Arial, Liberation Sans, Nimbus Sans, Helvetica, DejaVu Sans, sans-serif';

export const kLight: Look = {
  theme: 'light',
  background: '#ffffff',
  text: '#1b1f24',
  muted: '#57606a',
  grid: '#e3e6ea',
  accent: '#0063a6',
  bad: '#b3261e',
  series: ['#0072b2', '#d55e00', '#009e73', '#aa4499', '#b58900', '#3a9bd9', '#5b5b5b', '#882255'],
  font: kFont,
};

export const kDark: Look = {
  theme: 'dark',
  background: '#14181d',
  text: '#e6e9ed',
  muted: '#a3adb8',
  grid: '#2d343c',
  accent: '#6cb6ff',
  bad: '#ff8a80',
  series: ['#56b4e9', '#ff9d4d', '#2fd3a2', '#e39ac7', '#f0e442', '#8fc7ff', '#c2c8cf', '#d783a8'],
  font: kFont,
};

export interface SeriesStyle {
  color: string;
  dash: 'solid' | 'dashed' | 'dotted' | number[];
  symbol: string;
}

const kDashes: SeriesStyle['dash'][] = ['solid', 'dashed', 'dotted', [8, 3, 2, 3], [12, 4]];
const kSymbols = ['circle', 'triangle', 'rect', 'diamond', 'emptyCircle', 'emptyTriangle', 'emptyRect', 'emptyDiamond'];

// Returns the style of series `index`. 40 of them are all different.
export function get_series_style(look: Look, index: number): SeriesStyle {
  const round = Math.floor(index / look.series.length);
  return {
    color: look.series[index % look.series.length],
    dash: kDashes[round % kDashes.length],
    symbol: kSymbols[(index + round) % kSymbols.length],
  };
}
