// Makes parts of file names from names in the data: they contain letters, digits, dots and dashes.
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

// Returns one slug per name. All of them are different.
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
