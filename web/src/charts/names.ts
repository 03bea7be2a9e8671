// Names come from users' files: they may be long and may contain any characters.

// Control characters, and characters that turn the direction of the text around them.
const kInvisible = /[\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff]+/g;

// Returns the name with at most `length` characters. If it was cut, the last one is an ellipsis.
export function shorten(name: string, length = 40): string {
  const clean = name
    .slice(0, 4 * length)
    .replace(kInvisible, ' ')
    .trim();
  if (clean.length <= length) {
    return clean;
  }
  let end = length - 1;
  const last = clean.charCodeAt(end - 1);
  if (last >= 0xd800 && last <= 0xdbff) {
    --end; // do not cut through a character
  }
  return clean.slice(0, end).replace(/ +$/, '') + '…';
}

// Shortens names that stand beside each other, such as in a legend, so that they all stay
// different.
export function shorten_all(names: string[], length = 40): string[] {
  const taken: string[] = [];
  return names.map((name) => {
    const short = shorten(name, length) || 'unnamed';
    let label = short;
    for (let i = 2; taken.indexOf(label) >= 0; ++i) {
      label = `${shorten(short, length - 5)} (${i})`;
    }
    taken.push(label);
    return label;
  });
}

// Returns "a", "a and b" or "a, b and c".
export function join_names(names: string[]): string {
  return names.length < 2 ? names.join('') : names.slice(0, -1).join(', ') + ' and ' + names[names.length - 1];
}
