// Labels of points that cover neither each other nor the points.
import type { Look } from './look';
import type { Part } from './parts';
import { estimate_width } from './scales';

interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

function overlap(a: Box, b: Box): number {
  const wide = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
  const high = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
  return wide > 0 && high > 0 ? wide * high : 0;
}

// Places each label where it covers the fewest points and other labels. Places near its point are
// preferred.
export function place_labels(points: [number, number][], texts: string[], size: number, frame: Box): Box[] {
  const taken: Box[] = points.map(([x, y]) => ({ x: x - 5, y: y - 5, width: 10, height: 10 }));
  return texts.map((text, i) => {
    const width = estimate_width(text, size) + 2;
    const height = size + 2;
    let best: Box | null = null;
    let least = Infinity;
    [8, 20, 34, 50, 68].forEach((far) => {
      for (let k = 0; k < 16; ++k) {
        const angle = (k * Math.PI) / 8;
        const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
        const box = {
          x: points[i][0] + far * cos + (cos > 0.3 ? 0 : cos < -0.3 ? -width : -width / 2),
          y: points[i][1] + far * sin - height / 2,
          width,
          height,
        };
        const outside =
          Math.max(0, frame.x - box.x) +
          Math.max(0, box.x + width - frame.x - frame.width) +
          Math.max(0, frame.y - box.y) +
          Math.max(0, box.y + height - frame.y - frame.height);
        const cost = taken.reduce((sum, other) => sum + overlap(box, other), 0) * 10 + outside * 100 + far * 0.5 + (k % 8) * 0.01;
        if (cost < least) {
          least = cost;
          best = box;
        }
      }
    });
    const box = best ?? { x: points[i][0], y: points[i][1], width, height };
    taken.push(box);
    return box;
  });
}

type Drawing = { coord(point: number[]): number[] };

// Returns the labels of points of a chart on Cartesian axes.
export function make_labels(look: Look, places: [number, number][], texts: string[]): Part {
  return {
    type: 'custom',
    data: places.length > 0 ? [places[0]] : [],
    silent: true,
    z: 4,
    renderItem: (item: { coordSys: Box }, api: Drawing) => {
      const points = places.map((place) => api.coord(place) as [number, number]);
      const size = 11;
      const boxes = place_labels(points, texts, size, item.coordSys);
      const children: Part[] = [];
      texts.forEach((text, i) => {
        const box = boxes[i];
        const [x, y] = points[i];
        const left = box.x + box.width / 2 < x;
        const near: [number, number] = [Math.min(box.x + box.width, Math.max(box.x, x)), Math.min(box.y + box.height, Math.max(box.y, y))];
        if (Math.abs(near[0] - x) + Math.abs(near[1] - y) > 14) {
          children.push({
            type: 'line',
            shape: { x1: x, y1: y, x2: near[0], y2: near[1] },
            style: { stroke: look.muted, lineWidth: 0.7 },
          });
        }
        children.push({
          type: 'text',
          style: {
            x: left ? box.x + box.width - 1 : box.x + 1,
            y: box.y + box.height / 2,
            text,
            fill: look.text,
            stroke: look.background,
            lineWidth: 2,
            font: size + 'px ' + look.font,
            textAlign: left ? 'right' : 'left',
            textVerticalAlign: 'middle',
          },
        });
      });
      return { type: 'group', children };
    },
  };
}
