// Where links lead: pages of the site, files of the repository that the site takes along, other sites; and whether it is there.
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join, posix } from 'node:path';
import { list_files } from './navigation.mjs';

const kElsewhere = /^[a-z][a-z0-9+.-]*:/i;

export function is_elsewhere(target) {
  return kElsewhere.test(target);
}

// A link of a Markdown page as {file, anchor}: a path from the root.
export function split_target(source, target) {
  const [path, anchor = ''] = decodeURI(target).split('#');
  return { file: path === '' ? source : posix.normalize(posix.join(dirname(source), path)), anchor };
}

// What is wrong with the links of Markdown pages: [{source, links, anchors: Set}] -> texts.
export function find_dead_links(root, pages) {
  const anchors = new Map(pages.map((page) => [page.source, page.anchors]));
  const faults = [];
  for (const { source, links } of pages) {
    for (const target of links.filter((link) => !is_elsewhere(link))) {
      const { file, anchor } = split_target(source, target);
      if (file.startsWith('..') || !existsSync(join(root, file))) {
        faults.push(`${source}: ${target}: there is no such file`);
      } else if (anchor !== '' && anchors.has(file) && !anchors.get(file).has(anchor)) {
        faults.push(`${source}: ${target}: ${file} has no heading of that name; it has ${[...anchors.get(file)].join(', ')}`);
      }
    }
  }
  return faults;
}

// The same of the built site: every href and src of every page leads to a file of it, and to an id that is there. Nothing is loaded from
// elsewhere: links may lead out, scripts, styles and images may not.
export function find_dead_addresses(site) {
  const pages = list_files(site).filter((path) => path.endsWith('.html'));
  const texts = new Map(pages.map((page) => [page, readFileSync(join(site, page), 'utf8')]));
  const ids = new Map([...texts].map(([page, text]) => [page, new Set([...text.matchAll(/\sid="([^"]*)"/g)].map((match) => match[1]))]));
  const faults = [];
  for (const [page, text] of texts) {
    for (const [, tag, attribute, raw] of text.matchAll(/<(\w+)\b[^>]*?\s(href|src)="([^"]*)"/g)) {
      const address = raw.replaceAll('&amp;', '&');
      if (is_elsewhere(address)) {
        if (tag !== 'a' && !address.startsWith('data:')) {
          faults.push(`${page}: <${tag} ${attribute}="${address}">: it is loaded from elsewhere`);
        }
        continue;
      }
      const { file, anchor } = split_target(page, address);
      if (!existsSync(join(site, file))) {
        faults.push(`${page}: ${address}: there is no such file`);
      } else if (anchor !== '' && ids.has(file) && !ids.get(file).has(anchor)) {
        faults.push(`${page}: ${address}: ${file} has no such part`);
      }
    }
  }
  return faults;
}
