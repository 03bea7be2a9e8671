// docs/site.json: which pages the site has, and in which order. Every page of docs stands in it exactly once, or the site is not built.
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { basename, dirname, join, posix } from 'node:path';

export class SiteError extends Error {}

// The files below a folder, as paths from the root with /.
export function list_files(root, folder = '') {
  return readdirSync(join(root, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = posix.join(folder, entry.name);
    return entry.isDirectory() ? list_files(root, path) : [path];
  });
}

// Those that are pages; templates of pages are none.
export function list_pages(root, folder = 'docs') {
  return list_files(root, folder)
    .filter((path) => path.endsWith('.md') && !path.endsWith('.template.md'))
    .sort();
}

// Where a page lies in the site: docs/a/b.md at a/b.html, README.md at readme.html, a folder's README.md at its index.html.
export function place_page(page) {
  const inside = posix.relative('docs', page);
  if (inside.startsWith('..')) {
    return `${basename(page, '.md').toLowerCase()}.html`;
  }
  const folder = dirname(inside);
  const name = basename(inside) === 'README.md' && folder !== '.' ? 'index' : basename(inside, '.md');
  return posix.join(folder === '.' ? '' : folder, `${name}.html`);
}

// The first heading of a page.
export function read_title(text, page) {
  const heading = text.match(/^# (.+)$/m);
  if (!heading) {
    throw new SiteError(`${page}: it has no title: a first line that begins with '# '`);
  }
  return heading[1].trim();
}

const kStep = /\n+Next: \[(.+)\]\(([^()]+)\)\.\n*$/;

// Splits the next step from the text of a page: its last line, "Next: [words](page.md).".
function split_step(text, source) {
  const [line, words, target] = text.match(kStep) ?? [];
  return line === undefined
    ? { text, step: null }
    : { text: `${text.slice(0, -line.length)}\n`, step: { words, source: posix.join(dirname(source), target) } };
}

// {title, sections: [{title, folded, pages: [page]}], pages: [page]} with pages as {source, place, title, label, text, step, section}.
export function read_navigation(root) {
  const file = 'docs/site.json';
  const navigation = JSON.parse(readFileSync(join(root, file), 'utf8'));
  const seen = new Map();
  const make_page = (entry, section) => {
    const { page: source, label } = typeof entry === 'string' ? { page: entry } : entry;
    if (!existsSync(join(root, source))) {
      throw new SiteError(`${file}: section '${section}' names ${source}, which is not there`);
    }
    if (seen.has(source)) {
      throw new SiteError(`${file}: ${source} stands in the sections '${seen.get(source)}' and '${section}'; once is enough`);
    }
    seen.set(source, section);
    const text = readFileSync(join(root, source), 'utf8');
    const title = read_title(text, source);
    return { source, place: place_page(source), title, label: label ?? title.replaceAll('`', ''), section, ...split_step(text, source) };
  };
  const sections = navigation.sections.map(({ title, folded = false, pages, folder }) => {
    const entries = [...pages];
    const named = new Set(entries.map((entry) => entry.page ?? entry));
    if (folder) {
      entries.push(...list_pages(root, folder).filter((page) => !named.has(page)));
    }
    return { title, folded, pages: entries.map((entry) => make_page(entry, title)) };
  });
  const orphans = list_pages(root).filter((page) => !seen.has(page));
  if (orphans.length > 0) {
    throw new SiteError(`${file}: these pages stand in no section, so that nobody would find them: ${orphans.join(', ')}`);
  }
  const pages = sections.flatMap((section) => section.pages);
  const lost = pages.filter(({ step }) => step !== null && !pages.some(({ source }) => source === step.source));
  if (lost.length > 0) {
    throw new SiteError(lost.map(({ source, step }) => `${source}: its next step ${step.source} is no page of the site`).join('\n'));
  }
  return { title: navigation.title, sections, pages };
}
