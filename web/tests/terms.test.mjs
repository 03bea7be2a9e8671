// The terms that pages explain, against the glossary.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from './load.mjs';

const { kTerms, split_terms } = await load(`export { kTerms, split_terms } from './src/app/terms';`);

test('every term has the word and the meaning of the glossary', () => {
  const glossary = new Map(
    readFileSync(new URL('../../docs/glossary.md', import.meta.url), 'utf8')
      .split('\n')
      .filter((line) => line.startsWith('| '))
      .map((line) => line.split('|').map((cell) => cell.trim().replace(/[*`]/g, '')))
      .map((cells) => [cells[1], cells[2]]),
  );
  for (const { name, meaning } of kTerms) {
    assert.equal(meaning, glossary.get(name), name);
  }
});

const list = (text) => split_terms(text).map((part) => (part.term ? `[${part.text}: ${part.term.name}]` : part.text));

test('terms are found in sentences, each at its first appearance', () => {
  assert.deepEqual(list("(A12 of cmaes 0.93, p = 0.01 after Holm). Holm's correction; the a12."), [
    '(',
    '[A12: A12]',
    ' of cmaes 0.93, p = 0.01 after ',
    "[Holm: Holm's correction]",
    "). Holm's correction; the a12.",
  ]);
  assert.deepEqual(list("Friedman's test, in the form of Iman and Davenport"), [
    "[Friedman's test: Friedman's test]",
    ', in the form of ',
    "[Iman and Davenport: Iman and Davenport's form]",
  ]);
  assert.deepEqual(list('lower quartile'), ['[lower quartile: quartiles]']);
  assert.deepEqual(list('replicated runs, unscheduled'), ['replicated runs, unscheduled']);
  assert.deepEqual(list(''), []);
});

test('the parts of a text are the text', () => {
  const text = kTerms.map((term) => term.meaning).join(' ') + '</script>';
  assert.equal(
    split_terms(text)
      .map((part) => part.text)
      .join(''),
    text,
  );
});
