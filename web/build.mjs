// Builds what the program carries in itself, into the folder named on the command line:
//   page.js     the page's script, in one piece
//   page.css    its style
//   figures.js  the same figures without a browser, for `armwright plot`, in ES5 for the engine there
import { build, transform } from 'esbuild';
import { mkdir, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import ts from 'typescript';

const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const out = process.argv[2];
if (out === undefined) {
  console.error('usage: node build.mjs FOLDER');
  process.exit(2);
}
await mkdir(out, { recursive: true });

await build({
  entryPoints: { page: join(source, 'app/main.ts') },
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii', // the page must survive any handling as text
  legalComments: 'inline',
  outdir: out,
  logLevel: 'warning',
});

// TypeScript lowers the bundle, as esbuild cannot go below ES2015; minifying comes last.
const bundle = await build({
  entryPoints: [join(source, 'plot/main.ts')],
  bundle: true,
  format: 'iife',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'inline',
  write: false,
  logLevel: 'warning',
});
const lowered = ts.transpileModule(bundle.outputFiles[0].text, {
  compilerOptions: { target: ts.ScriptTarget.ES5, module: ts.ModuleKind.None, allowJs: true },
});
// Its syntax stays as it is: the engine does not read all of what the minifier makes of it.
const figures = await transform(lowered.outputText, {
  minifyWhitespace: true,
  minifyIdentifiers: true,
  target: 'es5',
  charset: 'ascii',
  legalComments: 'inline',
});
await writeFile(join(out, 'figures.js'), figures.code);
