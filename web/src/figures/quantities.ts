// The units for readers: an arm's errors in millimetres and angles in degrees, other units as they are.
import { shorten } from '../charts/names';
import { format_number, kDegrees, kMillimetres } from '../numbers';
import type { Quantity } from '../data';

export interface Shown {
  name: string;
  unit: string;
  factor: number; // factor from SI
}

export function get_shown(quantity: Quantity): Shown {
  const name = shorten(quantity.name);
  if (quantity.own_unit) {
    return { name, unit: quantity.unit === '1' ? '' : shorten(quantity.unit, 20), factor: 1 };
  }
  switch (quantity.unit) {
    case 'm':
      return { name, unit: 'mm', factor: kMillimetres };
    case 'rad':
      return { name, unit: '°', factor: kDegrees };
    default:
      return { name, unit: shorten(quantity.unit, 20), factor: 1 };
  }
}

export function name_axis(name: string, unit: string): string {
  return unit === '' ? name : `${name} (${unit})`;
}

export function is_number(value: number | null | undefined): value is number {
  return typeof value === 'number' && isFinite(value);
}

export function times(value: number | null | undefined, factor: number): number | null {
  return is_number(value) ? value * factor : null;
}

// Returns whether a logarithmic axis can show the values.
export function are_positive(values: (number | null)[]): boolean {
  const numbers = values.filter(is_number);
  return numbers.length > 0 && numbers.every((value) => value > 0);
}

export function find_range(values: (number | null)[]): [number, number] | null {
  const numbers = values.filter(is_number);
  if (numbers.length === 0) {
    return null;
  }
  let low = numbers[0];
  let high = numbers[0];
  numbers.forEach((value) => {
    low = Math.min(low, value);
    high = Math.max(high, value);
  });
  return [low, high];
}

export function flatten<T>(lists: T[][]): T[] {
  const all: T[] = [];
  lists.forEach((list) => list.forEach((one) => all.push(one)));
  return all;
}

export const kAtLimit = 1 - 1e-4; // share of a limit from which a torque counts as at the limit; torques are packed in 16 bits

// Returns the torque as a share of the limit on its side, or null without a limit.
export function find_limit_share(effort: number, limits: readonly [number | null, number | null] | undefined): number | null {
  const limit = limits === undefined ? null : limits[effort < 0 ? 0 : 1];
  return is_number(limit) && limit !== 0 ? effort / limit : null;
}

// Returns the word of a category, or a number as a text. A value between two words is a number.
export function format_choice(choices: string[], value: number | null): string {
  return is_number(value) && choices[value] !== undefined ? shorten(choices[value], 24) : format_number(value);
}

// Returns "12 cases" or "1 case".
export function count_of(count: number, thing: string): string {
  return `${count} ${thing}${count === 1 ? '' : 's'}`;
}
