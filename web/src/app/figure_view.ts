// The view of a figure in the page: its choices, its chart, the text of a chosen point, the values at
// the pointer, the zoom, and the downloads.
import { echarts, type EChartsOption, type EChartsType } from '../charts/echarts';
import { kLight, type Look } from '../charts/look';
import { fit_width, kNarrow_px } from '../charts/narrow';
import { draw_svg, get_initial_picks, get_paper_size, kDefaultHeight } from '../charts/svg';
import { can_zoom, read_curves, zoom_in, type Range, type Selected } from '../charts/zoom';
import { to_csv } from '../csv';
import type { Column, Figure, Picked, Provenance } from '../model';
import { format_number } from '../numbers';
import { CrossHair, type Crossing } from './cross_hair';
import { make, make_button, make_select } from './dom';
import { download } from './download';
import { add_gestures, find_panel } from './gestures';
import { make_provenance } from './provenance';
import { describe_table } from './spoken';
import { show_table } from './table_view';
import { make_text } from './term_view';
import { make_time_key, type Change, type Clock } from './clock';
import type { View } from './view';

interface Hovered {
  seriesName?: string;
  name?: string;
  value?: unknown;
  data?: unknown;
  marker?: unknown;
}

function get_provenance(data: unknown): Provenance {
  if (data !== null && typeof data === 'object' && !Array.isArray(data)) {
    return data as Provenance;
  }
  return {};
}

// Returns the text for the pointer over a point, as nodes. Names never become markup.
function describe_point(hovered: Hovered | Hovered[], columns: Column[]): HTMLElement {
  const box = make('div', { class: 'tip' });
  for (const one of Array.isArray(hovered) ? hovered : [hovered]) {
    const values = Array.isArray(one.value) ? one.value : [one.value];
    const numbers = values
      .filter((value): value is number | string => typeof value === 'number' || typeof value === 'string')
      .slice(0, Math.max(2, columns.length))
      .map((value) => (typeof value === 'number' ? format_number(value) : value));
    const { note, command, file } = get_provenance(one.data);
    if (!note) {
      box.append(make('strong', {}, one.seriesName ?? one.name ?? ''));
    }
    box.append(make('div', {}, note ?? numbers.join(', ')));
    if (file) {
      box.append(make('div', { class: 'tip-hint' }, 'Choose the point to save this design.'));
    } else if (command) {
      box.append(make('div', { class: 'tip-hint' }, 'Choose the point to see the command that reproduces it.'));
    }
  }
  return box;
}

type Named = { name?: string } | { name?: string }[];

const kLegendHint = 'Click to hide or show. Double-click or Alt-click to see this one alone.';

// Returns the option with what only a page has: the series that the reader has switched on, a hint at
// the entries of the legend, and the text for the pointer over a point.
function add_page_parts(
  option: EChartsOption,
  look: Look,
  selected: Selected | undefined,
  describe: (hovered: Hovered | Hovered[]) => HTMLElement,
) {
  const { legend, tooltip } = option as { legend?: { selected?: Selected }; tooltip?: { trigger?: string } };
  return {
    ...option,
    legend: legend && {
      ...legend,
      selected: selected ?? legend.selected,
      tooltip: { show: true, formatter: () => make('div', { class: 'tip' }, kLegendHint) },
    },
    tooltip: {
      ...tooltip,
      // The cross-hair shows the values of curves.
      trigger: tooltip?.trigger === 'axis' ? 'none' : tooltip?.trigger,
      formatter: describe,
      backgroundColor: look.background,
      borderColor: look.muted,
      textStyle: { color: look.text },
      confine: true,
    },
  };
}

// Returns the series to show after the reader asked for `name` alone: this one, or all if it was
// already alone.
function isolate(selected: Selected, name: string): Selected {
  const is_alone = Object.keys(selected).every((one) => one === name || !selected[one]);
  const after: Selected = {};
  Object.keys(selected).forEach((one) => {
    after[one] = is_alone || one === name;
  });
  return after;
}

function to_list<T>(parts: T | T[] | undefined): T[] {
  return parts === undefined ? [] : Array.isArray(parts) ? parts : [parts];
}

export function make_figure_view(first: Figure, look: Look, clock: Clock): View {
  let figure = first;
  const picked: Picked = get_initial_picks(figure);
  let current_look = look;
  let chart: EChartsType | null = null;
  const plot = make('div', {
    class: 'plot',
    role: 'img',
  });
  plot.style.height = (figure.height ?? kDefaultHeight) + 'px';
  let drawn_width = 0; // pixels; a narrow chart depends on its width
  let drawn: EChartsOption = {}; // for a wide place
  let drawn_zoom: Range | null = null;
  let is_zoomable = false;
  let selected: Selected | undefined; // undefined until the reader uses the legend of these series
  let drawn_names: string | undefined; // of the legend
  const cursor = make('div', { class: 'cursor', 'aria-hidden': 'true' });
  const cross_hair = new CrossHair();
  const band = add_gestures(
    plot,
    () => (is_zoomable ? chart : null),
    () => to_list((drawn as { xAxis?: object }).xAxis).length,
    {
      on_point: (panel, x) => clock.point(get_key(), x + get_part(panel).from),
      on_leave: () => clock.point(get_key(), null),
      on_click: (panel, x) => {
        if (figure.time !== undefined) {
          clock.set(figure.time.replay, figure.time.case(picked), x + get_part(panel).from);
        }
      },
      on_range: (panel, { from, to }) => clock.zoom(get_key(), { from: from + get_part(panel).from, to: to + get_part(panel).from }),
      on_reset: () => clock.zoom(get_key(), null),
    },
  );
  const frame = make('div', { class: 'frame' }, plot, cursor, cross_hair.element, band);
  const details = make('div', { class: 'details', role: 'status' });
  const reset = make_button('Reset zoom', () => clock.zoom(get_key(), null), {
    class: 'reset-zoom',
    hidden: '',
    title: 'Escape or a double click, too',
  });

  // Returns the name of the abscissa, which figures over the time of the same case share. The choices
  // of another figure may change its abscissa.
  function get_key(): string {
    return figure.time === undefined
      ? `figure ${figure.id} ${JSON.stringify(picked)}`
      : make_time_key(figure.time.replay, figure.time.case(picked));
  }

  // Returns the part of the shared abscissa that a panel shows. Its own abscissa begins with it.
  function get_part(panel: number): Range {
    return figure.time?.panels?.(picked)[panel] ?? { from: 0, to: Infinity };
  }

  function get_selected(): Selected {
    return selected ?? (drawn as { legend?: { selected?: Selected } }).legend?.selected ?? {};
  }

  function find_zooms(): (Range | null)[] {
    const zoom = clock.zoom_of(get_key());
    return to_list((drawn as { xAxis?: object }).xAxis).map((_, i) => {
      const part = get_part(i);
      if (zoom === null || zoom.to <= part.from || zoom.from >= part.to) {
        return null;
      }
      const is_part = part.to < Infinity;
      return { from: is_part ? Math.max(0, zoom.from - part.from) : zoom.from, to: Math.min(zoom.to, part.to) - part.from };
    });
  }

  function draw(): void {
    if (chart === null) {
      return;
    }
    drawn_width = plot.clientWidth;
    const zoom = clock.zoom_of(get_key());
    drawn_zoom = zoom;
    drawn = figure.draw(current_look, picked, zoom ?? undefined);
    const names = JSON.stringify((drawn as { legend?: { data?: unknown[] } }).legend?.data);
    if (names !== drawn_names) {
      drawn_names = names;
      selected = undefined;
    }
    is_zoomable = can_zoom(drawn);
    plot.classList.toggle('zoomable', is_zoomable);
    zoom_hint.hidden = !is_zoomable;
    const zooms = find_zooms();
    drawn = zoom === null ? drawn : zoom_in(current_look, drawn, zooms, get_selected());
    reset.hidden = zooms.every((one) => one === null);
    const { option, height_px } = fit_width(drawn, drawn_width, figure.height ?? kDefaultHeight);
    if (plot.clientHeight !== height_px) {
      plot.style.height = height_px + 'px';
      chart.resize();
    }
    plot.setAttribute('aria-label', `${figure.title}. ${describe_table(figure.table(picked))}`);
    // Computing a table can take long and pointers move often, so the columns are computed once per
    // drawing.
    let columns: ReturnType<typeof figure.table>['columns'] | null = null;
    const describe = (hovered: Hovered | Hovered[]): HTMLElement => {
      columns ??= figure.table(picked).columns;
      return describe_point(hovered, columns);
    };
    chart.setOption(add_page_parts(option, current_look, selected, describe), { notMerge: true });
    move_cursor();
    move_cross_hair();
  }

  // Shows the time of the replay as a line over the panels that have it. The chart itself does not
  // change.
  function move_cursor(): void {
    cursor.hidden = true;
    const time = figure.time;
    if (chart === null || time === undefined || clock.replay !== time.replay || clock.case_id !== time.case(picked)) {
      return;
    }
    const places = find_places(chart, clock.time_s);
    const last = places[places.length - 1];
    if (last === undefined) {
      return;
    }
    // Panels below each other have one line.
    const panels = places.filter(({ x_px }) => Math.abs(x_px - last.x_px) < 0.5).map(({ panel }) => panel);
    const top = Math.min(...panels.map((panel) => panel.y));
    cursor.hidden = false;
    cursor.style.transform = `translate(${last.x_px}px, ${top}px)`;
    cursor.style.height = `${Math.max(...panels.map((panel) => panel.y + panel.height)) - top}px`;
  }

  // Returns where a place of the shared abscissa is in each panel that shows it.
  function find_places(on: EChartsType, at: number): { index: number; panel: Crossing['panel']; x_px: number }[] {
    const places: { index: number; panel: Crossing['panel']; x_px: number }[] = [];
    to_list((drawn as { xAxis?: object }).xAxis).forEach((_, index) => {
      const part = get_part(index);
      const panel = find_panel(on, index);
      const x_px = on.convertToPixel({ xAxisIndex: index }, at - part.from) as number;
      if (at >= part.from && at <= part.to && x_px >= panel.x - 0.5 && x_px <= panel.x + panel.width + 0.5) {
        places.push({ index, panel, x_px });
      }
    });
    return places;
  }

  function move_cross_hair(): void {
    const { tooltip, xAxis, yAxis } = drawn as { tooltip?: { trigger?: string }; xAxis?: Named; yAxis?: Named };
    const at = clock.pointer?.key === get_key() ? clock.pointer.at : null;
    if (chart === null || at === null || tooltip?.trigger !== 'axis' || !is_zoomable) {
      cross_hair.show([]);
      return;
    }
    const names = to_list(xAxis).map((axis) => axis.name ?? '');
    cross_hair.show(
      find_places(chart, at).map(({ index, panel, x_px }) => ({
        panel,
        x_px,
        at: at - get_part(index).from,
        x_name: names[index] || names[names.length - 1],
        y_name: to_list(yAxis)[index]?.name ?? '',
        readings: read_curves(drawn, index, at - get_part(index).from, get_selected()),
      })),
    );
  }

  // If the replay shows another case and the figure has the choice of a case, the figure shows that
  // case too.
  function follow_clock(change: Change): void {
    const time = figure.time;
    if (change === 'pointer') {
      move_cross_hair();
      return;
    }
    if (change === 'zoom') {
      if (drawn_zoom !== clock.zoom_of(get_key())) {
        draw();
      }
      return;
    }
    if (time !== undefined && clock.replay === time.replay && clock.case_id !== time.case(picked)) {
      for (const choice of figure.choices ?? []) {
        const option = choice.options.find((one) => time.case({ ...picked, [choice.id]: one.value }) === clock.case_id);
        if (option !== undefined) {
          picked[choice.id] = option.value;
          selects[choice.id].value = option.value;
          draw();
          break;
        }
      }
    }
    move_cursor();
  }

  function show_details(provenance: Provenance): void {
    details.replaceChildren();
    if (provenance.note || provenance.command) {
      details.append(make_provenance(provenance, () => details.replaceChildren()));
    }
  }

  function mount(): void {
    if (chart !== null || plot.clientWidth === 0) {
      return;
    }
    chart = echarts.init(plot, null, { renderer: 'svg' });
    draw();
    chart.on('click', (event) => {
      show_details(get_provenance(event.data));
    });
    chart.on('legendselectchanged', (event) => {
      const { name, selected: after } = event as unknown as { name: string; selected: Selected };
      selected = is_alone_click ? isolate(after, name) : after;
      if (is_alone_click) {
        draw();
      }
      move_cross_hair();
    });
  }

  // The chart hears of a click after this listener.
  let is_alone_click = false;
  plot.addEventListener(
    'click',
    (event) => {
      is_alone_click = event.detail === 2 || event.altKey || event.ctrlKey || event.metaKey;
    },
    { capture: true },
  );
  const on_key = (event: KeyboardEvent): void => {
    const is_typing = event.target instanceof HTMLInputElement && event.target.type === 'search';
    if (event.key === 'Escape' && !is_typing && document.querySelector('dialog[open]') === null) {
      clock.zoom(get_key(), null);
    }
  };
  // After a tap the values stay until the next one.
  const on_tap = (event: PointerEvent): void => {
    if (event.pointerType !== 'mouse' && !plot.contains(event.target as Node)) {
      clock.point(get_key(), null);
    }
  };
  document.addEventListener('keydown', on_key);
  document.addEventListener('pointerdown', on_tap);

  const choices = make('div', { class: 'choices' });
  const selects: Record<string, HTMLSelectElement> = {};
  for (const choice of figure.choices ?? []) {
    const select = make_select(choice.options, choice.initial, (value) => {
      picked[choice.id] = value;
      show_details({});
      selected = undefined;
      draw();
      if (figure.time !== undefined && figure.time.case(picked) !== clock.case_id) {
        clock.set(figure.time.replay, figure.time.case(picked), 0);
      }
    });
    selects[choice.id] = select;
    choices.append(make('label', { class: 'choice' }, make('span', {}, choice.label), select));
  }
  const buttons = make(
    'div',
    { class: 'buttons' },
    reset,
    make_button('Table', () => show_table(figure.title, figure.table(picked)), { title: 'The numbers of this figure' }),
    make_button('CSV', () => download(figure.id + '.csv', 'text/csv', to_csv(figure.table(picked))), {
      title: 'Download the numbers of this figure',
    }),
    make_button(
      'SVG',
      () => {
        const { width, height } = get_paper_size(figure);
        download(figure.id + '.svg', 'image/svg+xml', draw_svg(figure, kLight, picked, width, height));
      },
      { title: 'Download this figure' },
    ),
  );
  const caption_text = make('span', {}, ...make_text(figure.caption));
  const zoom_hint = make('span', { class: 'zoom-hint', hidden: '' }, ' Drag across the plot to zoom.');
  const caption = make('figcaption', {}, caption_text, zoom_hint);
  const element = make(
    'figure',
    { class: figure.width === 'full' ? 'card full' : 'card', id: 'figure-' + figure.id, 'data-figure': figure.id },
    make(
      'div',
      { class: 'card-head' },
      make('h3', {}, figure.title),
      figure.thesis ? make('span', { class: 'thesis', title: 'The corresponding figure of the thesis' }, 'thesis, ' + figure.thesis) : null,
      buttons,
    ),
    choices.childElementCount > 0 ? choices : null,
    frame,
    details,
    caption,
  );
  const observer = new ResizeObserver(() => {
    mount();
    chart?.resize();
    if (chart !== null && plot.clientWidth !== drawn_width && Math.min(plot.clientWidth, drawn_width) < kNarrow_px) {
      draw();
    }
    move_cursor();
    move_cross_hair();
  });
  observer.observe(plot);
  const stop_listening = clock.listen(follow_clock);

  return {
    element,
    set_look(next: Look) {
      current_look = next;
      draw();
    },
    update(item) {
      const choices_of = (one: Figure): string => JSON.stringify(one.choices ?? []);
      if (item.kind !== 'figure' || choices_of(item) !== choices_of(figure)) {
        return false;
      }
      if (item.caption !== figure.caption) {
        caption_text.replaceChildren(...make_text(item.caption));
      }
      figure = item;
      element.classList.toggle('full', item.width === 'full');
      draw();
      return true;
    },
    settle: mount,
    dispose() {
      stop_listening();
      document.removeEventListener('keydown', on_key);
      document.removeEventListener('pointerdown', on_tap);
      observer.disconnect();
      chart?.dispose();
      chart = null;
    },
  };
}
