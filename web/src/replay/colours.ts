// The colours of errors: a logarithmic scale ordered by lightness alone, so that readers need not
// distinguish hues. A larger error is further from the background. This file does not use the DOM.
export type Rgb = [number, number, number]; // each 0 to 1

export interface ColourScale {
  lower_m: number;
  upper_m: number;
  stops: Rgb[];
}

const kOnLight: Rgb[] = [
  [0.58, 0.78, 0.9],
  [0.3, 0.55, 0.82],
  [0.38, 0.25, 0.66],
  [0.42, 0.03, 0.28],
];
const kOnDark: Rgb[] = [
  [0.22, 0.36, 0.62],
  [0.52, 0.44, 0.86],
  [0.93, 0.56, 0.55],
  [1, 0.92, 0.5],
];

const kLeast_m = 1e-5; // smaller errors have the colour of this one
const kMost_m = 1; // larger errors have the colour of this one, so that an arm that runs away does not hide the others
const kMostDecades = 4;

// Returns a scale of whole decades around the errors. It has at most four decades, because the
// smallest errors matter least.
export function make_colour_scale(errors_m: ArrayLike<number>[], theme: 'light' | 'dark'): ColourScale {
  let least = Infinity;
  let most = 0;
  for (const errors of errors_m) {
    for (let i = 0; i < errors.length; ++i) {
      if (isFinite(errors[i])) {
        least = Math.min(least, Math.max(kLeast_m, errors[i]));
        most = Math.max(most, Math.min(kMost_m, errors[i]));
      }
    }
  }
  const stops = theme === 'light' ? kOnLight : kOnDark;
  if (most <= kLeast_m) {
    return { lower_m: kLeast_m, upper_m: 10 * kLeast_m, stops };
  }
  const top = Math.ceil(Math.log10(most) - 1e-9);
  const bottom = Math.max(top - kMostDecades, Math.min(top - 1, Math.floor(Math.log10(least) + 1e-9)));
  return { lower_m: Math.pow(10, bottom), upper_m: Math.pow(10, top), stops };
}

// Returns 0 at the lower end, and 1 at the upper end and above.
export function find_share(scale: ColourScale, error_m: number): number {
  if (!(error_m > scale.lower_m)) {
    return 0;
  }
  return Math.min(1, Math.log(error_m / scale.lower_m) / Math.log(scale.upper_m / scale.lower_m));
}

export function find_colour(scale: ColourScale, error_m: number): Rgb {
  const place = find_share(scale, error_m) * (scale.stops.length - 1);
  const whole = Math.min(scale.stops.length - 2, Math.floor(place));
  const share = place - whole;
  const a = scale.stops[whole];
  const b = scale.stops[whole + 1];
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])];
}

export function to_css(colour: Rgb): string {
  return `rgb(${colour.map((part) => Math.round(255 * part)).join(', ')})`;
}

// Returns the decades of the scale, in m.
export function list_decades(scale: ColourScale): number[] {
  const decades: number[] = [];
  for (let value = scale.lower_m; value < scale.upper_m * 1.001; value *= 10) {
    decades.push(value);
  }
  return decades;
}
