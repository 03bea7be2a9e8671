// What is searched, and how: the same when the index is made and when it is asked. A document is a part of a page, from heading to heading.

// Words that stand in every question and say nothing about its subject.
const kStopWords = new Set(
  (
    'a about all am an and any are as at be but by can could do does for from get had has have how i if in into is it its me much my no not of on ' +
    'or our out should so some than that the their them then there these they this to up us use using was we were what when where which who why ' +
    'will with would you your'
  ).split(' '),
);

// Words of one meaning. Readers use any of them, and the pages mostly the first. Plurals in s count as the word itself.
const kSynonyms = [
  ['robot', 'arm', 'manipulator'],
  ['urdf', 'robot'],
  ['my', 'own', 'bring'],
  ['tune', 'optimize', 'optimise', 'improve', 'train'],
  ['controller', 'gain', 'pid'],
  ['compare', 'benchmark', 'comparison', 'versus', 'vs'],
  ['plugin', 'own optimizer', 'extend'],
  ['add', 'write', 'create', 'new'],
  ['error', 'accuracy', 'accurate', 'precise', 'precision'],
  ['torque', 'effort', 'force'],
  ['path', 'trajectory', 'task', 'target'],
  ['load', 'payload', 'perturbed', 'robust', 'unknown', 'noise'],
  ['resume', 'continue', 'crash', 'interrupt', 'journal', 'abort'],
  ['check', 'verify', 'validate', 'trust'],
  ['checksum', 'damaged', 'corrupt', 'broken', 'doctor'],
  ['report', 'page', 'browser', 'plot', 'chart'],
  ['cluster', 'slurm', 'parallel', 'mpi'],
  ['fast', 'speed', 'scaling', 'core', 'thread'],
  ['install', 'setup', 'build', 'download'],
  ['replicate', 'repetition', 'repeat', 'seed'],
  ['failure', 'fail', 'failed', 'diverge'],
  ['mean', 'meaning', 'definition', 'glossary', 'defined'],
  ['limit', 'constraint', 'bound', 'requirement'],
  ['engine', 'simulator', 'physics', 'mujoco', 'ode'],
  ['best', 'winner', 'leader', 'ranking', 'findings'],
];
const kSynonymWeight = 0.5; // of a synonym, against a word that was typed

function split_names(text) {
  const words = text.toLowerCase().split(/[^\p{L}\p{N}_:.-]+/u);
  const all = words.flatMap((word) => [word.replace(/^[-.:]+|[-.:]+$/g, ''), ...word.split(/[:._-]+/)]);
  return [...new Set(all)].filter((word) => word.length > 1);
}

export const kSearch = {
  fields: ['title', 'page', 'text'],
  storeFields: ['place', 'slug', 'page', 'title', 'text'],
  searchOptions: {
    prefix: (word) => word.length > 2,
    fuzzy: (word) => (word.length > 4 ? 0.2 : 0),
    combineWith: 'OR',
    boost: { title: 3, page: 4 },
    boostDocument: (_, __, { place, slug }) => weigh_part(place, slug),
  },
  // Names such as --simd, nlopt:sbplx and task.ik_bug are found by their pieces and as a whole.
  tokenize: split_names,
  processTerm: (word) => (kStopWords.has(word) ? null : word),
};

// A newcomer needs tutorials first. Fifty pages of optimizers have the same words, and the history names everything.
function weigh_part(place, slug) {
  const page = place.startsWith('tutorials/')
    ? 1.5
    : /^(optimizers\/(?!index)|reference\/)/.test(place)
      ? 0.7
      : /^(changelog|contributing|findings)/.test(place)
        ? 0.5
        : 1;
  return slug === '' ? 1.6 * page : page;
}

function find_synonyms(words) {
  const typed = new Set(words.flatMap((word) => [word, word.replace(/s$/, '')]));
  const groups = kSynonyms.filter((group) => group.some((word) => typed.has(word)));
  return [...new Set(groups.flat())].filter((word) => !typed.has(word));
}

// Returns the parts for a question in a reader's words, best first. At most `kMostOfPage` of them are of one page.
const kMostOfPage = 2;
export function find_parts(index, question) {
  const synonyms = find_synonyms(split_names(question));
  const weaken = Object.fromEntries(kSearch.fields.map((field) => [field, kSynonymWeight * (kSearch.searchOptions.boost[field] ?? 1)]));
  const results = index.search({
    combineWith: 'OR',
    queries: [question, { queries: [synonyms.join(' ')], combineWith: 'OR', boost: weaken, fuzzy: false, prefix: false }],
  });
  const counts = new Map();
  return results.filter(({ place }) => {
    counts.set(place, (counts.get(place) ?? 0) + 1);
    return counts.get(place) <= kMostOfPage;
  });
}

const kShown = 120; // characters of a part that a result shows

// The place in a part's text where the first of the words that were found stands.
export function make_excerpt(text, words) {
  const lower = text.toLowerCase();
  const places = words.map((word) => lower.indexOf(word.toLowerCase())).filter((place) => place >= 0);
  const place = places.length > 0 ? Math.min(...places) : 0;
  const begin = place < kShown / 2 ? 0 : text.indexOf(' ', place - kShown / 3) + 1;
  const end = begin + kShown;
  return `${begin > 0 ? '... ' : ''}${text.slice(begin, end)}${end < text.length ? ' ...' : ''}`;
}

export function make_documents(page, parts) {
  const title_of = (part) => (part.title === page.title.replaceAll('`', '') ? '' : part.title);
  return parts
    .filter((part) => part.text.trim() !== '' || part.title !== '')
    .map((part, index) => ({
      id: `${page.place}#${index}`,
      place: page.place,
      slug: title_of(part) === '' ? '' : part.slug,
      page: page.label,
      title: title_of(part),
      text: part.text.replaceAll(/\s+/g, ' ').trim(),
    }));
}
