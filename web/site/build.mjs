// Builds the documentation's site from README.md, CHANGELOG.md and docs into a folder, which is made anew:
//
//   node site/build.mjs FOLDER [--links]
//
// It needs no network and no server, and neither does what it builds: open FOLDER/index.html. --links lists what leads to other sites.
// docs/site.json names the pages.
import { build } from 'esbuild';
import MiniSearch from 'minisearch';
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { find_way, make_html } from './layout.mjs';
import { find_dead_addresses, find_dead_links, is_elsewhere, split_target } from './links.mjs';
import { make_renderer } from './markdown.mjs';
import { SiteError, read_navigation } from './navigation.mjs';
import { kSearch, make_documents } from './search.mjs';

const here = dirname(fileURLToPath(import.meta.url));

// Every page of the navigation as {page, html, headings, parts, links}; files that they link to are remembered in `taken`.
export function render_pages(navigation, taken = new Set()) {
  const places = new Map(navigation.pages.map((page) => [page.source, page.place]));
  const render = make_renderer();
  return navigation.pages.map((page) => {
    const lead = (target) => {
      if (is_elsewhere(target)) {
        return target;
      }
      const { file, anchor } = split_target(page.source, target);
      if (!places.has(file)) {
        taken.add(file);
      }
      const way = file === page.source && anchor ? '' : find_way(page.place, places.get(file) ?? `files/${file}`);
      return anchor ? `${way}#${anchor}` : way;
    };
    return { page, ...render(page.text, lead) };
  });
}

export function check_links(root, rendered) {
  return find_dead_links(
    root,
    rendered.map(({ page, links, headings }) => ({
      source: page.source,
      links,
      anchors: new Set(headings.map(({ slug }) => slug)),
    })),
  );
}

export async function build_site(root, out) {
  const navigation = read_navigation(root);
  const taken = new Set();
  const rendered = render_pages(navigation, taken);
  const faults = check_links(root, rendered);
  if (faults.length > 0) {
    throw new SiteError(faults.join('\n'));
  }
  const version = readFileSync(join(root, 'CMakeLists.txt'), 'utf8').match(/project\(armwright VERSION ([\d.]+)/)?.[1] ?? '';

  rmSync(out, { recursive: true, force: true });
  const write = (place, text) => {
    mkdirSync(dirname(join(out, place)), { recursive: true });
    writeFileSync(join(out, place), text);
  };
  for (const one of rendered) {
    write(one.page.place, make_html(navigation, one.page, one, version));
  }
  for (const file of taken) {
    mkdirSync(dirname(join(out, 'files', file)), { recursive: true });
    cpSync(join(root, file), join(out, 'files', file), { recursive: true });
  }
  const index = new MiniSearch(kSearch);
  index.addAll(rendered.flatMap(({ page, parts }) => make_documents(page, parts)));
  write('search-index.js', `globalThis.armwright_index=${JSON.stringify(index)};\n`);
  await build({
    entryPoints: { site: join(here, 'client.mjs') },
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2020',
    charset: 'ascii',
    legalComments: 'inline',
    outdir: out,
    logLevel: 'warning',
  });
  cpSync(join(here, 'site.css'), join(out, 'site.css'));

  const dead = find_dead_addresses(out);
  if (dead.length > 0) {
    throw new SiteError(dead.join('\n'));
  }
  return {
    pages: rendered.length,
    elsewhere: rendered.flatMap(({ page, links }) => links.filter(is_elsewhere).map((link) => `${page.source}: ${link}`)),
  };
}

if (process.argv[1] && resolve(process.argv[1]) === fileURLToPath(import.meta.url)) {
  const [out, flag] = process.argv.slice(2);
  if (!out || (flag && flag !== '--links')) {
    console.error('usage: node site/build.mjs FOLDER [--links]');
    process.exit(2);
  }
  try {
    const { pages, elsewhere } = await build_site(join(here, '../..'), out);
    console.log(flag ? elsewhere.join('\n') : `${join(out, 'index.html')}: ${pages} pages`);
  } catch (error) {
    if (!(error instanceof SiteError)) {
      throw error;
    }
    console.error(`site: ${error.message}`);
    process.exit(1);
  }
}
