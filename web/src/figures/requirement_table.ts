// The traffic lights: the requirements for the winner, and whether it meets them. A sign and words
// repeat the meaning of each colour.
import type { RequirementLight } from '../data';
import type { Cell, TableItem, Value } from '../model';
import { get_shown, times } from './quantities';

const kStates: { [grade in RequirementLight['grade']]: { text: string; mark: NonNullable<Cell['mark']> } } = {
  met: { text: '✓ met', mark: 'good' },
  tight: { text: '! met, within 10 % of the limit', mark: 'near' },
  missed: { text: '✗ missed', mark: 'bad' },
  unknown: { text: '? not shown: a case has no number', mark: 'none' },
};

function make_row(light: RequirementLight): (Value | Cell)[] {
  const is_share = light.quantity.unit === '1';
  const shown = get_shown(light.quantity);
  const factor = is_share ? 100 : shown.factor;
  const state = kStates[light.grade];
  return [
    shown.name,
    light.is_constraint ? 'constraint' : 'report',
    light.limit * factor,
    times(light.value, factor),
    is_share ? '%' : shown.unit,
    times(light.value, 100 / light.limit),
    { value: state.text + (light.binds ? '; this limit binds' : ''), mark: state.mark },
  ];
}

export function make_requirement_table(lights: RequirementLight[]): TableItem | null {
  if (lights.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'requirements-table',
    title: 'Requirements',
    caption:
      'Whether the winner meets its requirements on the worst case of the test set. ' +
      'The limit that binds is the one with the largest share in the column "of the limit". ' +
      'The optimizer knew only the requirements that are constraints.',
    table: {
      columns: [
        { label: 'requirement' },
        { label: 'use' },
        { label: 'at most', numeric: true },
        { label: 'worst case', numeric: true },
        { label: 'unit' },
        { label: 'of the limit', unit: '%', numeric: true, digits: 3 },
        { label: 'state' },
      ],
      rows: lights.map(make_row),
    },
  };
}
