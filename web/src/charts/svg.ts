// Draws a figure as SVG text, in a browser or without one.
import type { Figure, Picked } from '../model';
import { echarts } from './echarts';
import type { Look } from './look';

export const kDefaultHeight = 340;

export function get_initial_picks(figure: Figure): Picked {
  const picked: Picked = {};
  (figure.choices ?? []).forEach((choice) => {
    picked[choice.id] = choice.initial;
  });
  return picked;
}

// Returns the size of a figure for a paper, in pixels: 640 x 400. Figures that are larger in the
// page are larger in proportion.
export function get_paper_size(figure: Figure): { width: number; height: number } {
  const width = figure.width === 'full' ? 960 : 640;
  return { width, height: Math.round(((figure.height ?? kDefaultHeight) * 400) / kDefaultHeight) };
}

export function draw_svg(figure: Figure, look: Look, picked: Picked, width: number, height: number): string {
  const chart = echarts.init(null, null, { renderer: 'svg', ssr: true, width, height });
  try {
    chart.setOption(figure.draw(look, picked));
    return chart.renderToSVGString();
  } finally {
    chart.dispose();
  }
}
