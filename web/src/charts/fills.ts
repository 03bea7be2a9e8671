// Colours between two others, and texts that can be read on them.
interface Rgb {
  red: number;
  green: number;
  blue: number;
}

function parse_color(hex: string): Rgb {
  const part = (from: number) => parseInt(hex.slice(from, from + 2), 16);
  return { red: part(1), green: part(3), blue: part(5) };
}

function parse_rgb(color: string): Rgb {
  const [red, green, blue] = color.slice(4, -1).split(',').map(Number);
  return { red, green, blue };
}

// Returns the colour at `share` of the way between two colours such as "#0072b2".
export function mix(from: string, to: string, share: number): string {
  const [a, b] = [parse_color(from), parse_color(to)];
  const one = (x: number, y: number) => Math.round(x + (y - x) * Math.min(1, Math.max(0, share)));
  return 'rgb(' + one(a.red, b.red) + ',' + one(a.green, b.green) + ',' + one(a.blue, b.blue) + ')';
}

// Returns black or white, whichever has more contrast with the fill: at least 4.5, as WCAG 2 asks
// for. Its relative luminance is computed with a gamma of 2.2.
export function get_readable(fill: string): string {
  const light = (part: number) => Math.pow(part / 255, 2.2);
  const parts = fill.charAt(0) === '#' ? parse_color(fill) : parse_rgb(fill);
  const luminance = 0.2126 * light(parts.red) + 0.7152 * light(parts.green) + 0.0722 * light(parts.blue);
  return luminance > 0.18 ? '#000000' : '#ffffff';
}
