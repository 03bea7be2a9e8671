// The documentation's site: its parts by themselves, then all of the documentation: no page without a way to it, no link that leads nowhere.
import MiniSearch from 'minisearch';
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import test, { after } from 'node:test';
import { fileURLToPath } from 'node:url';
import { build_site, check_links, render_pages } from '../site/build.mjs';
import { find_dead_addresses } from '../site/links.mjs';
import { make_renderer, make_slug, render_fence, render_name, render_session } from '../site/markdown.mjs';
import { SiteError, place_page, read_navigation } from '../site/navigation.mjs';
import { find_parts, kSearch, make_documents, make_excerpt } from '../site/search.mjs';

const kRoot = join(dirname(fileURLToPath(import.meta.url)), '../..');
const scratch = mkdtempSync(join(tmpdir(), 'armwright-site-'));
after(() => rmSync(scratch, { recursive: true, force: true }));

let count = 0;
// A repository of these files; docs/site.json names all pages but those in `unlisted`.
function make_root(files, unlisted = []) {
  const root = join(scratch, `root-${++count}`);
  const pages = Object.keys(files).filter((file) => file.endsWith('.md') && !unlisted.includes(file));
  const all = {
    'CMakeLists.txt': 'project(armwright VERSION 7.8.9',
    'docs/site.json': JSON.stringify({ title: 'T', sections: [{ title: 'S', pages }] }),
    ...files,
  };
  for (const [file, text] of Object.entries(all)) {
    mkdirSync(dirname(join(root, file)), { recursive: true });
    writeFileSync(join(root, file), text);
  }
  return root;
}

test('anchors are those of GitHub', () => {
  assert.equal(make_slug('3. Tune it (one minute)'), '3-tune-it-one-minute');
  assert.equal(make_slug("What `--simd` & K's *do*"), 'what---simd--ks-do');
  const { headings, html } = make_renderer()('# A\n\n## For `x`: y\n\n## For x: y\n', (target) => target);
  assert.deepEqual(
    headings.map(({ slug }) => slug),
    ['a', 'for-x-y', 'for-x-y-1'],
  );
  assert.match(html, /<h2 id="for-x-y"/);
});

test('pages lie where links from disk find them', () => {
  assert.equal(place_page('docs/tutorials/tune.md'), 'tutorials/tune.html');
  assert.equal(place_page('docs/optimizers/README.md'), 'optimizers/index.html');
  assert.equal(place_page('README.md'), 'readme.html');
  assert.equal(place_page('docs/index.md'), 'index.html');
});

test('links to pages lead to pages, links to files take the files along', async () => {
  const root = make_root({
    'docs/index.md': '# I\n\n[a](a/b.md#part) [l](../LICENSE) [o](https://example.org) [own](#i)\n\n![p](p.png)\n',
    'docs/a/b.md': '# B\n\n## Part\n\n[back](../index.md)\n',
    'docs/p.png': 'picture',
    LICENSE: 'free',
  });
  const out = join(scratch, 'links');
  const { pages, elsewhere } = await build_site(root, out);
  assert.equal(pages, 2);
  assert.deepEqual(elsewhere, ['docs/index.md: https://example.org']);
  const html = readFileSync(join(out, 'index.html'), 'utf8');
  for (const address of ['a/b.html#part', 'files/LICENSE', 'https://example.org', '#i', 'files/docs/p.png']) {
    assert.ok(html.includes(`="${address}"`), address);
  }
  assert.match(readFileSync(join(out, 'a/b.html'), 'utf8'), /href="\.\.\/index\.html"[^]*7\.8\.9/);
  assert.equal(readFileSync(join(out, 'files/LICENSE'), 'utf8'), 'free');
  // What breaks afterwards is found as well.
  rmSync(join(out, 'files/LICENSE'));
  writeFileSync(join(out, 'a/b.html'), '<a href="../index.html#gone">x</a><script src="https://example.org/x.js"></script>');
  assert.deepEqual(find_dead_addresses(out).sort(), [
    'a/b.html: ../index.html#gone: index.html has no such part',
    'a/b.html: <script src="https://example.org/x.js">: it is loaded from elsewhere',
    'index.html: a/b.html#part: a/b.html has no such part',
    'index.html: files/LICENSE: there is no such file',
  ]);
});

async function refuse(root, message) {
  const out = join(scratch, 'refused');
  await assert.rejects(build_site(root, out), (error) => {
    assert.ok(error instanceof SiteError, error.stack);
    assert.match(error.message, message);
    return true;
  });
  assert.ok(!existsSync(out), 'a site was written all the same');
}

test('a site with dead links, forgotten pages or pages twice is not built', async () => {
  await refuse(make_root({ 'docs/index.md': '# I\n\n[x](b.md)\n' }), /docs\/index\.md: b\.md: there is no such file/);
  await refuse(make_root({ 'docs/index.md': '# I\n\n[x](#j)\n' }), /#j: docs\/index\.md has no heading of that name; it has i/);
  await refuse(make_root({ 'docs/index.md': '# I\n\n[x](../../etc/passwd)\n' }), /there is no such file/);
  await refuse(
    make_root({ 'docs/index.md': '# I\n', 'docs/b.md': '# B\n' }, ['docs/b.md']),
    /stand in no section, so that nobody would find them: docs\/b\.md/,
  );
  await refuse(make_root({ 'docs/index.md': 'text\n' }), /docs\/index\.md: it has no title/);
  const sections = [
    { title: 'S', pages: ['docs/index.md'] },
    { title: 'T', pages: ['docs/index.md'] },
  ];
  await refuse(
    make_root({ 'docs/index.md': '# I\n', 'docs/site.json': JSON.stringify({ title: 'T', sections }) }),
    /stands in the sections 'S' and 'T'/,
  );
  const gone = [{ title: 'S', pages: ['docs/gone.md'] }];
  await refuse(
    make_root({ 'docs/site.json': JSON.stringify({ title: 'T', sections: gone }) }),
    /section 'S' names docs\/gone\.md, which is not there/,
  );
});

test('the last line of a page names its next step, and the site shows it at the foot', async () => {
  const root = make_root({
    'docs/index.md': '# I\n\ntext\n\nNext: [how `b` works](a/b.md).\n',
    'docs/c.md': '# C\n',
    'docs/a/b.md': '# B\n',
  });
  const out = join(scratch, 'steps');
  await build_site(root, out);
  const read = (place) => readFileSync(join(out, place), 'utf8');
  assert.match(read('index.html'), /class="after" href="a\/b\.html"><span>Next<\/span>How b works</);
  assert.doesNotMatch(read('index.html'), /Next: /);
  assert.match(read('c.html'), /class="after" href="a\/b\.html"><span>Next<\/span>B</);
  assert.match(read('a/b.html'), /class="after" href="\.\.\/index\.html"/); // after the last page, the first
  await refuse(
    make_root({ 'docs/index.md': '# I\n\nNext: [x](y.md).\n' }),
    /docs\/index\.md: its next step docs\/y\.md is no page of the site/,
  );
});

test('every page of the documentation has a next step where it is read as a file', () => {
  const pages = read_navigation(kRoot).pages.filter(({ source }) => source.startsWith('docs/'));
  const kSteps = /\n## Where to go next\n(?!.*\n#)/s; // a last section of several steps
  assert.ok(pages.length > 90, `${pages.length}`);
  const without = pages.filter(({ step, text }) => step === null && !kSteps.test(text));
  assert.deepEqual(
    without.map(({ source }) => source),
    [],
    "these pages have no last line such as 'Next: [words](page.md).'",
  );
});

test('of a session only what is typed can be copied, and nothing in it is markup', () => {
  const html = render_session('$ a --b <c> # why\nprinted <d>\n$ e \\\n>   f\nmore');
  assert.deepEqual(
    [...html.matchAll(/class="typed">(.*)<\/span>$/gm)].map((match) => match[1].replaceAll(/<[^>]*>/g, '')),
    ['a --b &lt;c&gt; # why', 'e \\', '  f'],
  );
  assert.match(html, /<span class="printed">printed &lt;d&gt;<\/span>/);
  assert.match(render_fence('toml my_task.toml', 'a = 1\n'), /<figcaption>my_task\.toml<\/figcaption><button/);
  assert.doesNotMatch(render_fence('toml problem=q1', 'a = 1\n'), /figcaption|button/);
  assert.doesNotMatch(render_fence('text', '<script>\n'), /<script>/);
});

test('long names may break at their joints, short ones stay whole', () => {
  assert.equal(render_name('faults.Kill.AtEveryWriteOfARun'), '<code>faults.<wbr>Kill.<wbr>At<wbr>Every<wbr>Write<wbr>Of<wbr>ARun</code>');
  assert.equal(
    render_name('a/<b>/c_d=e-f/and/so/on/to'),
    '<code>a/&lt;b&gt;/<wbr>c_<wbr>d=<wbr>e-<wbr>f/<wbr>and/<wbr>so/<wbr>on/<wbr>to</code>',
  );
  assert.equal(render_name('nlopt:sbplx'), '<code>nlopt:sbplx</code>');
});

test('names are found whole and by their pieces', () => {
  assert.deepEqual(kSearch.tokenize('--simd nlopt:sbplx, task.ik_bug.'), [
    'simd',
    'nlopt:sbplx',
    'nlopt',
    'sbplx',
    'task.ik_bug',
    'task',
    'ik',
    'bug',
  ]);
  const page = { place: 'a.html', label: 'A', title: '`A`' };
  const documents = make_documents(page, [
    { slug: '', title: '', text: '' },
    { slug: 'a', title: 'A', text: 'one\n two ' },
    { slug: 'b', title: 'B', text: 'three' },
  ]);
  assert.deepEqual(
    documents.map(({ slug, title, text }) => [slug, title, text]),
    [
      ['', '', 'one two'],
      ['b', 'B', 'three'],
    ],
  );
  assert.equal(make_excerpt('short text', ['text']), 'short text');
  assert.match(make_excerpt(`${'word '.repeat(50)}needle ${'word '.repeat(50)}`, ['needle']), /^\.\.\. .*needle.* \.\.\.$/);
});

test('a question in the words of a newcomer finds its page among the first three', () => {
  const index = new MiniSearch(kSearch);
  index.addAll(render_pages(read_navigation(kRoot)).flatMap(({ page, parts }) => make_documents(page, parts)));
  const find_pages = (question) => [...new Set(find_parts(index, question).map(({ place }) => place.replace('.html', '')))];
  assert.equal(find_pages('how do I tune my own robot')[0], 'tutorials/bring-your-robot');
  const answers = {
    'which optimizer is best': 'tour',
    'how can I compare two optimizers': 'tutorials/compare',
    'write my own optimizer in Python': 'tutorials/add-an-optimizer',
    'how do I install it': 'install',
    'continue a run after a crash': 'journal',
    'run a study on a cluster with Slurm': 'clusters',
    'export the gains to ROS 2': 'exporting',
    'what does A12 mean': 'glossary',
    'limit the torque of a joint': 'requirements',
    'use armwright from Python': 'python',
    'define a path for the tool': 'tasks',
    'tune for a load that changes': 'robust',
    'overshoot and settling time': 'requirements',
    'check a design with another physics engine': 'verify',
    'show the results in a browser': 'tutorials/compare',
    'are my files damaged': 'doctor',
    'why is my URDF rejected': 'robots',
    'benchmark functions BBOB': 'functions',
    'how many replicates do I need': 'tutorials/compare',
    'PID gains of a controler': 'controllers', // a slip of the keyboard
    'how fast is it on many cores': 'scaling',
    'nlopt:sbplx': 'optimizers/nlopt-sbplx',
  };
  for (const [question, page] of Object.entries(answers)) {
    const found = find_pages(question).slice(0, 3);
    assert.ok(found.includes(page), `"${question}" finds ${found.join(', ')}, not ${page}`);
  }
  assert.deepEqual(find_pages('what is the'), [], 'words that say nothing');
});

test('every page of the documentation has its place, and every link of it leads somewhere', () => {
  const navigation = read_navigation(kRoot);
  assert.equal(navigation.pages[0].place, 'index.html');
  assert.equal(navigation.sections[1].title, 'Tutorials');
  assert.deepEqual(check_links(kRoot, render_pages(navigation)), []);
});
