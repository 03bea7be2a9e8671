// Which variables of a run matter: one figure per region, headed by how far its numbers can be trusted.
import { make_number_axis, make_plot } from '../charts/marks';
import { make_spans, type Part } from '../charts/parts';
import type { Importance, ImportancePart, RunData } from '../data';
import type { Figure, Item, TextItem, Value } from '../model';
import { format_number } from '../numbers';
import { count_of } from './quantities';

const kMostShown = 24; // variables of a figure; the table has all of them
const kRow_px = 26;
const kTitles = { run: 'over the whole run', winner: 'near the winner', design: 'by simulations around the winner' };

function make_figure(importance: Importance, part: ImportancePart): Figure {
  const sorted = part.variables.slice().sort((a, b) => b.total.value - a.total.value);
  const shown = sorted.slice(0, kMostShown);
  const unit = part.region === 'design' ? 'design' : 'evaluation';
  return {
    kind: 'figure',
    id: `importance-${part.region}`,
    title: `Variables that matter ${kTitles[part.region]}`,
    caption:
      `${part.judgement} Shares of the variance of ${importance.value} ${part.words}, from ${count_of(part.points, unit)}: the total index of a ` +
      'variable has all differences in which it takes part, the first index those that it causes alone. Lines are 95 % intervals.' +
      (sorted.length > shown.length ? ` The ${kMostShown} largest of ${sorted.length} variables are shown.` : ''),
    width: 'half',
    height: 110 + kRow_px * shown.length,
    draw: (look) => {
      // The first index is an open square over the dot of the total one, so that both show where they are equal.
      const make_parts = (name: 'total' | 'first', s: number): Part[] => {
        const label = `${name} index`;
        return [
          make_spans(
            label,
            shown.map((one, i): [number, number, number] => [i, one[name].lower, one[name].upper]),
            look.series[s],
          ),
          {
            type: 'scatter',
            name: label,
            data: shown.map((one) => ({
              value: [one[name].value, one.name],
              note: `${one.name}: ${label} ${format_number(one[name].value, 2)} (${format_number(one[name].lower, 2)} to ${format_number(one[name].upper, 2)}).`,
            })),
            symbol: s === 0 ? 'circle' : 'rect',
            symbolSize: s === 0 ? 10 : 7,
            itemStyle: s === 0 ? { color: look.series[s] } : { color: look.background, borderColor: look.series[s], borderWidth: 2 },
            z: 4 + s,
          },
        ];
      };
      return make_plot(
        look,
        make_number_axis(look, 'x', 'share of the variance', { min: 0, max: 1 }),
        {
          ...make_number_axis(look, 'y', '', { categories: shown.map((one) => one.name), inverse: true }),
          axisLabel: { color: look.text, fontFamily: look.font, fontSize: 11, interval: 0, width: 150, overflow: 'truncate' },
        },
        [...make_parts('total', 0), ...make_parts('first', 1)],
        { grid: { left: 166, right: 24, top: 44, bottom: 48 } },
      );
    },
    table: () => ({
      columns: [
        { label: 'variable' },
        { label: 'total', numeric: true, digits: 3 },
        { label: 'total, from', numeric: true, digits: 3 },
        { label: 'total, to', numeric: true, digits: 3 },
        { label: 'first', numeric: true, digits: 3 },
        { label: 'first, from', numeric: true, digits: 3 },
        { label: 'first, to', numeric: true, digits: 3 },
      ],
      rows: sorted.map((one): Value[] => [
        one.name,
        one.total.value,
        one.total.lower,
        one.total.upper,
        one.first.value,
        one.first.lower,
        one.first.upper,
      ]),
    }),
  };
}

// Returns the figures, and a text with the notes if there are any.
export function make_importance_items(data: RunData): Item[] {
  const importance = data.importance;
  if (importance === undefined || importance === null) {
    return [];
  }
  const notes: TextItem[] =
    importance.notes.length === 0
      ? []
      : [{ kind: 'text', id: 'importance-notes', title: 'About the variables that matter', paragraphs: importance.notes }];
  return [...importance.parts.map((part) => make_figure(importance, part)), ...notes];
}
