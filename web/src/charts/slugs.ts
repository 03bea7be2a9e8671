// Parts of files' names out of names from data: letters, digits, dots, dashes.
const kLongest = 40;

function make_slug(name: string): string {
  const slug = name
    .slice(0, 4 * kLongest)
    .toLowerCase()
    .replace(/[^a-z0-9.]+/g, '-')
    .slice(0, kLongest)
    .replace(/^[-.]+|[-.]+$/g, '');
  return slug === '' ? 'unnamed' : slug;
}

// All different.
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
