// Returns the indices of the values to draw so that a line looks the same: the first and the last
// value, and the smallest and the largest of each of limit / 2 stretches. Peaks are kept for every
// limit.
export function decimate(values: ArrayLike<number>, limit = 2000): number[] {
  const kept: number[] = [];
  const n = values.length;
  if (n <= limit) {
    for (let i = 0; i < n; ++i) {
      kept.push(i);
    }
    return kept;
  }
  const add = (i: number) => {
    if (kept.length === 0 || kept[kept.length - 1] < i) {
      kept.push(i);
    }
  };
  const stretches = Math.max(1, Math.floor(limit / 2) - 1);
  add(0);
  for (let stretch = 0; stretch < stretches; ++stretch) {
    const begin = Math.floor((stretch * n) / stretches);
    const end = Math.floor(((stretch + 1) * n) / stretches);
    let low = begin;
    let high = begin;
    for (let i = begin + 1; i < end; ++i) {
      // A comparison with NaN is false, so NaN is skipped unless a stretch begins with it.
      if (values[i] < values[low] || values[low] !== values[low]) {
        low = i;
      }
      if (values[i] > values[high] || values[high] !== values[high]) {
        high = i;
      }
    }
    add(Math.min(low, high));
    add(Math.max(low, high));
  }
  add(n - 1);
  return kept;
}
