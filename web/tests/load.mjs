// The page's code as a module for tests: Node cannot read TypeScript.
import { build } from 'esbuild';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

// `contents` are export statements, with paths from web/.
export async function load(contents) {
  const bundle = await build({
    stdin: { contents, resolveDir: join(dirname(fileURLToPath(import.meta.url)), '..'), loader: 'ts' },
    bundle: true,
    format: 'esm',
    write: false,
    logLevel: 'error',
  });
  return import(`data:text/javascript;base64,${Buffer.from(bundle.outputFiles[0].contents).toString('base64')}`);
}
