// The view of a figure in the page: its choices, its chart, the text of a chosen point, and the
// downloads.
import { echarts, type EChartsOption, type EChartsType } from '../charts/echarts';
import { kLight, type Look } from '../charts/look';
import { fit_width, kNarrow_px } from '../charts/narrow';
import { draw_svg, get_initial_picks, get_paper_size, kDefaultHeight } from '../charts/svg';
import { to_csv } from '../csv';
import type { Column, Figure, Picked } from '../model';
import { format_number } from '../numbers';
import { make, make_button, make_select } from './dom';
import { download } from './download';
import { make_provenance } from './provenance';
import { describe_table } from './spoken';
import { show_table } from './table_view';
import type { Clock } from './clock';
import type { View } from './view';

interface Hovered {
  seriesName?: string;
  name?: string;
  value?: unknown;
  data?: unknown;
  marker?: unknown;
}

function get_provenance(data: unknown): { note?: string; command?: string } {
  if (data !== null && typeof data === 'object' && !Array.isArray(data)) {
    return data as { note?: string; command?: string };
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
    const { note, command } = get_provenance(one.data);
    if (!note) {
      box.append(make('strong', {}, one.seriesName ?? one.name ?? ''));
    }
    box.append(make('div', {}, note ?? numbers.join(', ')));
    if (command) {
      box.append(make('div', { class: 'tip-hint' }, 'Choose the point to see the command that reproduces it.'));
    }
  }
  return box;
}

// Returns `option` with the series switched on that the reader has chosen, so that a new drawing
// keeps the choice.
function keep_selection(chart: EChartsType, option: EChartsOption): EChartsOption {
  const before = (chart.getOption() as { legend?: { selected?: Record<string, boolean> }[] } | undefined)?.legend?.[0]?.selected;
  const legend = (option as { legend?: object }).legend;
  return before === undefined || legend === undefined ? option : { ...option, legend: { ...legend, selected: before } };
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
  const cursor = make('div', { class: 'cursor', 'aria-hidden': 'true' });
  const frame = make('div', { class: 'frame' }, plot, cursor);
  const details = make('div', { class: 'details', role: 'status' });

  function draw(keep: boolean): void {
    if (chart === null) {
      return;
    }
    drawn_width = plot.clientWidth;
    const { option: drawn, height_px } = fit_width(figure.draw(current_look, picked), drawn_width, figure.height ?? kDefaultHeight);
    if (plot.clientHeight !== height_px) {
      plot.style.height = height_px + 'px';
      chart.resize();
    }
    plot.setAttribute('aria-label', `${figure.title}. ${describe_table(figure.table(picked))}`);
    // Computing a table can take long and pointers move often, so the columns are computed once per
    // drawing.
    let columns: ReturnType<typeof figure.table>['columns'] | null = null;
    chart.setOption(
      {
        ...(keep ? keep_selection(chart, drawn) : drawn),
        tooltip: {
          ...((drawn as { tooltip?: object }).tooltip ?? {}),
          formatter: (hovered: Hovered | Hovered[]) => {
            columns ??= figure.table(picked).columns;
            return describe_point(hovered, columns);
          },
          backgroundColor: current_look.background,
          borderColor: current_look.muted,
          textStyle: { color: current_look.text },
          confine: true,
        },
      },
      { notMerge: true },
    );
    move_cursor();
  }

  // Shows the time of the replay as a line over the chart. The chart itself does not change.
  function move_cursor(): void {
    const time = figure.time;
    const visible = chart !== null && time !== undefined && clock.replay === time.replay && clock.case_id === time.case(picked);
    cursor.hidden = !visible;
    if (visible && chart !== null) {
      const x = chart.convertToPixel({ xAxisIndex: 0 }, clock.time_s);
      const inside = chart.containPixel({ gridIndex: 0 }, [x, plot.clientHeight / 2]);
      cursor.hidden = !inside;
      cursor.style.transform = `translateX(${x}px)`;
    }
  }

  // If the replay shows another case and the figure has the choice of a case, the figure shows that
  // case too.
  function follow_clock(): void {
    const time = figure.time;
    if (time !== undefined && clock.replay === time.replay && clock.case_id !== time.case(picked)) {
      for (const choice of figure.choices ?? []) {
        const option = choice.options.find((one) => time.case({ ...picked, [choice.id]: one.value }) === clock.case_id);
        if (option !== undefined) {
          picked[choice.id] = option.value;
          selects[choice.id].value = option.value;
          draw(true);
          break;
        }
      }
    }
    move_cursor();
  }

  function show_details(note: string | undefined, command: string | undefined): void {
    details.replaceChildren();
    if (note || command) {
      details.append(make_provenance(note, command, () => details.replaceChildren()));
    }
  }

  function mount(): void {
    if (chart !== null || plot.clientWidth === 0) {
      return;
    }
    chart = echarts.init(plot, null, { renderer: 'svg' });
    draw(false);
    chart.on('click', (event) => {
      const { note, command } = get_provenance(event.data);
      show_details(note, command);
    });
    chart.getZr().on('click', (event: { offsetX: number; offsetY: number }) => {
      const time = figure.time;
      if (chart !== null && time !== undefined && chart.containPixel({ gridIndex: 0 }, [event.offsetX, event.offsetY])) {
        const seconds = chart.convertFromPixel({ xAxisIndex: 0 }, event.offsetX);
        clock.set(time.replay, time.case(picked), seconds as number);
      }
    });
  }

  const choices = make('div', { class: 'choices' });
  const selects: Record<string, HTMLSelectElement> = {};
  for (const choice of figure.choices ?? []) {
    const select = make_select(choice.options, choice.initial, (value) => {
      picked[choice.id] = value;
      show_details(undefined, undefined);
      draw(false);
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
  const caption = make('figcaption', {}, figure.caption);
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
      draw(true);
    }
    move_cursor();
  });
  observer.observe(plot);
  const stop_listening = clock.listen(follow_clock);

  return {
    element,
    set_look(next: Look) {
      current_look = next;
      draw(true);
    },
    update(item) {
      const choices_of = (one: Figure): string => JSON.stringify(one.choices ?? []);
      if (item.kind !== 'figure' || choices_of(item) !== choices_of(figure)) {
        return false;
      }
      figure = item;
      caption.textContent = item.caption;
      draw(true);
      return true;
    },
    settle: mount,
    dispose() {
      stop_listening();
      observer.disconnect();
      chart?.dispose();
      chart = null;
    },
  };
}
