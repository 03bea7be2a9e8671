// Formats and unpacks the numbers of the page.
import type { Packed } from './data';

export const kMillimetres = 1000;
export const kDegrees = 180 / Math.PI;

// Formats a number with `digits` significant digits. It has no exponent if it is short without one:
// "0.0741", "1040562", "2.5e-7".
export function format_number(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || !isFinite(value)) {
    return '–';
  }
  if (Math.floor(value) === value && Math.abs(value) < 1e9) {
    return String(value);
  }
  // The magnitude is that of the rounded number: 0.99999 has one digit before the point.
  const magnitude = Math.floor(Math.log10(Math.abs(Number(value.toPrecision(digits)))));
  if (magnitude < -4 || magnitude > 8) {
    return value.toExponential(digits - 1);
  }
  return value.toFixed(Math.min(20, Math.max(0, digits - 1 - magnitude)));
}

// Formats a time in seconds: "0.42 s", "3 min 5 s", "40 min", "2 h 10 min".
export function format_duration(seconds: number): string {
  if (seconds < 59.5) {
    return (seconds < 9.95 ? format_number(seconds, 2) : String(Math.round(seconds))) + ' s';
  }
  const whole = Math.round(seconds);
  const minutes = Math.round(seconds / 60);
  return whole < 600
    ? `${Math.floor(whole / 60)} min ${whole % 60} s`
    : minutes < 60
      ? `${minutes} min`
      : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function scale(values: (number | null)[], factor: number): (number | null)[] {
  return values.map((value) => (value === null ? null : value * factor));
}

const kAlphabet = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';

// Our own decoder, because there is no atob() outside a browser.
function decode_base64(text: string): Uint8Array {
  const places: number[] = [];
  for (let i = 0; i < kAlphabet.length; ++i) {
    places[kAlphabet.charCodeAt(i)] = i;
  }
  let length = text.length;
  while (length > 0 && text.charAt(length - 1) === '=') {
    --length;
  }
  const bytes = new Uint8Array(Math.floor((length * 3) / 4));
  let bits = 0;
  let count = 0;
  let next = 0;
  for (let i = 0; i < length; ++i) {
    bits = ((bits << 6) | places[text.charCodeAt(i)]) & 0xffffff;
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes[next++] = (bits >> count) & 0xff;
    }
  }
  return bytes;
}

export function unpack(packed: Packed): Float32Array {
  const bytes = decode_base64(packed.f32 ?? packed.i16 ?? '');
  if (packed.f32 !== undefined) {
    return new Float32Array(bytes.buffer);
  }
  const integers = new Int16Array(bytes.buffer);
  const values = new Float32Array(integers.length);
  for (let i = 0; i < integers.length; ++i) {
    values[i] = (packed.offset ?? 0) + (packed.scale ?? 1) * integers[i];
  }
  return values;
}

export function unpack_indices(packed: Packed): Uint32Array {
  return new Uint32Array(decode_base64(packed.u32 ?? '').buffer);
}
