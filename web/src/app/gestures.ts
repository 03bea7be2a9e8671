// The gestures over the panels of a chart: pointing, dragging over a range, and a double click. A
// finger only points, so that it can scroll the page.
import type { EChartsType } from '../charts/echarts';
import type { Range } from '../charts/zoom';
import { make } from './dom';

export interface Rect {
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface GestureEvents {
  on_point(panel: number, x: number): void;
  on_leave(): void;
  on_click(panel: number, x: number): void; // not at the end of a drag
  on_range(panel: number, range: Range): void;
  on_reset(): void; // a double click in a panel
}

const kShortestDrag_px = 6; // a shorter one is a click

// Returns the place of a panel in its chart. The public functions of ECharts do not give it.
export function find_panel(chart: EChartsType, panel: number): Rect {
  type Model = { getComponent(kind: string, index: number): { coordinateSystem: { getRect(): Rect } } };
  return (chart as unknown as { getModel(): Model }).getModel().getComponent('grid', panel).coordinateSystem.getRect();
}

// Returns the band that marks the dragged range. It belongs over the chart in `plot`.
export function add_gestures(
  plot: HTMLElement,
  get_chart: () => EChartsType | null,
  count: () => number,
  events: GestureEvents,
): HTMLElement {
  const band = make('div', { class: 'zoom-band', hidden: '', 'aria-hidden': 'true' });
  let drag: { panel: number; from_px: number; is_long: boolean } | null = null;
  let ends_drag = false; // the click that the browser reports next

  const get_place = (event: MouseEvent): [number, number] => {
    const { left, top } = plot.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };
  // Returns the panel under the pointer, or null if none is there.
  const find_at = (event: MouseEvent): { chart: EChartsType; panel: number; x_px: number } | null => {
    const chart = get_chart();
    const place = get_place(event);
    for (let panel = 0; chart !== null && panel < count(); ++panel) {
      if (chart.containPixel({ gridIndex: panel }, place)) {
        return { chart, panel, x_px: place[0] };
      }
    }
    return null;
  };
  const read = (chart: EChartsType, panel: number, x_px: number): number => chart.convertFromPixel({ xAxisIndex: panel }, x_px) as number;
  const end_drag = (): void => {
    drag = null;
    band.hidden = true;
  };
  // Returns the ends of the drag within its panel, in pixels.
  const find_ends = (chart: EChartsType, x_px: number): [number, number] => {
    const { x, width } = find_panel(chart, drag?.panel ?? 0);
    const to_px = Math.min(x + width, Math.max(x, x_px));
    const from_px = drag?.from_px ?? to_px;
    return [Math.min(from_px, to_px), Math.max(from_px, to_px)];
  };

  const point = (event: MouseEvent): void => {
    const at = find_at(event);
    if (at === null) {
      events.on_leave();
    } else {
      events.on_point(at.panel, read(at.chart, at.panel, at.x_px));
    }
  };

  plot.addEventListener('pointerdown', (event) => {
    const at = find_at(event);
    ends_drag = false;
    if (event.pointerType === 'mouse' && event.button === 0 && at !== null) {
      drag = { panel: at.panel, from_px: at.x_px, is_long: false };
    }
  });
  plot.addEventListener('pointermove', (event) => {
    const chart = get_chart();
    if (event.buttons === 0) {
      end_drag(); // the button was released elsewhere
    }
    if (drag === null || chart === null) {
      if (event.pointerType === 'mouse') {
        point(event);
      }
      return;
    }
    const x_px = get_place(event)[0];
    if (!drag.is_long && Math.abs(x_px - drag.from_px) >= kShortestDrag_px) {
      // From now on the chart gets no events, so the end of the drag is no click in it.
      plot.setPointerCapture(event.pointerId);
      drag.is_long = true;
      events.on_leave();
    }
    if (drag.is_long) {
      const [left, right] = find_ends(chart, x_px);
      const { y, height } = find_panel(chart, drag.panel);
      band.hidden = false;
      band.style.transform = `translate(${left}px, ${y}px)`;
      band.style.width = `${right - left}px`;
      band.style.height = `${height}px`;
    }
  });
  plot.addEventListener('pointerup', (event) => {
    const chart = get_chart();
    ends_drag = drag?.is_long ?? false;
    if (drag?.is_long && chart !== null) {
      const [left, right] = find_ends(chart, get_place(event)[0]);
      if (right - left >= kShortestDrag_px) {
        events.on_range(drag.panel, { from: read(chart, drag.panel, left), to: read(chart, drag.panel, right) });
      }
    }
    end_drag();
  });
  plot.addEventListener('pointercancel', end_drag);
  plot.addEventListener('pointerleave', (event) => {
    if (event.pointerType === 'mouse') {
      events.on_leave();
    }
  });
  // A tap, too. ECharts reports no click if it has drawn the chart anew between press and release.
  plot.addEventListener('click', (event) => {
    point(event);
    const at = find_at(event);
    if (at !== null && !ends_drag) {
      events.on_click(at.panel, read(at.chart, at.panel, at.x_px));
    }
  });
  plot.addEventListener('dblclick', (event) => {
    if (find_at(event) !== null) {
      events.on_reset();
    }
  });
  return band;
}
