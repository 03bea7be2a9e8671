// What the comparisons of two runs and of two studies share: settings, and words for differences.
import { join_names } from '../charts/names';
import type { ComparedSetting } from '../data';
import type { TableItem, Value } from '../model';
import { format_number } from '../numbers';

// Returns "-20 %" for the way from `a` to `b`; "" if that says nothing.
export function describe_change(a: number, b: number): string {
  if (!(a > 0 && b > 0)) {
    return '';
  }
  const percent = (100 * (b - a)) / a;
  return (percent > 0 ? '+' : percent < 0 ? '−' : '') + format_number(Math.abs(percent), 2) + ' %';
}

export function find_differences(settings: ComparedSetting[]): ComparedSetting[] {
  return settings.filter((one) => one.a !== one.b);
}

function make_settings_table(settings: ComparedSetting[], id: string, title: string, caption: string): TableItem {
  const show = (value: string | null): Value => (value === null ? '–' : value);
  return {
    kind: 'table',
    id,
    title,
    caption,
    table: {
      columns: [{ label: 'setting' }, { label: 'A' }, { label: 'B' }],
      rows: settings.map((one) => [one.name, show(one.a), show(one.b)]),
    },
  };
}

// Returns the table of the settings that differ; null if there is none.
export function make_differences_table(settings: ComparedSetting[]): TableItem | null {
  const differences = find_differences(settings);
  return differences.length === 0
    ? null
    : make_settings_table(
        differences,
        'differences',
        'Settings that differ',
        'A dash means that this side does not have the setting. The tab Settings has the rest.',
      );
}

export function make_equal_table(settings: ComparedSetting[]): TableItem | null {
  const equal = settings.filter((one) => one.a === one.b);
  return equal.length === 0 ? null : make_settings_table(equal, 'equal-settings', 'Settings that both have', '');
}

// Returns the parts of the basis of the comparison in which the sides differ, in words.
export function find_obstacles(settings: ComparedSetting[]): string[] {
  const parts = find_differences(settings).map((one) => one.basis);
  return parts.filter((part, i): part is string => part !== null && parts.indexOf(part) === i);
}

// Returns "the engine and the budget differ".
export function describe_obstacles(obstacles: string[]): string {
  return `${join_names(obstacles)} ${obstacles.length === 1 ? 'differs' : 'differ'}`;
}
