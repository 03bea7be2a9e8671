// Names from data, made fit to be drawn. They are untrusted: whatever could hide, turn around or end
// text is made visible, and what is long is cut.

const kUnfit = /[\u0000-\u001f\u007f-\u009f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufdd0-\ufdef\ufeff\ufffe\uffff]/g;
export const kLongestName = 40;

// With an ellipsis where it was longer. Half of a surrogate pair is no character.
export function shorten(name: string, most = kLongestName): string {
  let clean = name.slice(0, 8 * most).replace(kUnfit, '\ufffd');
  if (clean.length > most) {
    clean = clean.slice(0, most - 1);
    const last = clean.charCodeAt(clean.length - 1);
    clean = (last >= 0xd800 && last <= 0xdbff ? clean.slice(0, -1) : clean) + '…';
  }
  clean = clean.replace(/[\ud800-\udbff](?![\udc00-\udfff])/g, '\ufffd').replace(/(^|[^\ud800-\udbff])[\udc00-\udfff]/g, '$1\ufffd');
  return clean.trim() === '' ? '(no name)' : clean;
}

// Names to tell series apart by: those that have become the same are numbered.
export function shorten_all(names: string[], most = kLongestName): string[] {
  const taken: string[] = [];
  names.forEach((name) => {
    const short = shorten(name, most);
    let unique = short;
    for (let i = 2; taken.indexOf(unique) >= 0; ++i) {
      unique = shorten(short, most - 5) + ' (' + i + ')';
    }
    taken.push(unique);
  });
  return taken;
}

// Part of a file's name: letters, digits, dots, dashes.
export function make_slug(name: string): string {
  const slug = name
    .toLowerCase()
    .replace(/[^a-z0-9.]+/g, '-')
    .slice(0, kLongestName)
    .replace(/^[-.]+|[-.]+$/g, '');
  return slug === '' ? 'unnamed' : slug;
}

export function make_slugs(names: string[]): string[] {
  const taken: string[] = [];
  names.forEach((name) => {
    const slug = make_slug(name);
    let unique = slug;
    for (let i = 2; taken.indexOf(unique) >= 0; ++i) {
      unique = slug + '-' + i;
    }
    taken.push(unique);
  });
  return taken;
}
