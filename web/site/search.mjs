// What is searched, and how: the same when the index is made and when it is asked. A document is a part of a page, from heading to heading.
export const kSearch = {
  fields: ['title', 'page', 'text'],
  storeFields: ['place', 'slug', 'page', 'title', 'text'],
  searchOptions: { prefix: true, fuzzy: (word) => (word.length > 4 ? 0.2 : 0), combineWith: 'AND', boost: { title: 4, page: 2 } },
  // Names such as --simd, nlopt:sbplx and task.ik_bug are found by their pieces and as a whole.
  tokenize: (text) => {
    const words = text.toLowerCase().split(/[^\p{L}\p{N}_:.-]+/u);
    const all = words.flatMap((word) => [word.replace(/^[-.:]+|[-.:]+$/g, ''), ...word.split(/[:._-]+/)]);
    return [...new Set(all)].filter((word) => word.length > 1);
  },
};
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
