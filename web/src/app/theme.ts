export type Theme = 'light' | 'dark';

const kKey = 'armwright-theme';

// Pages from disk may have no storage.
export function load_theme(): Theme {
  try {
    const stored = localStorage.getItem(kKey);
    if (stored === 'light' || stored === 'dark') {
      return stored;
    }
  } catch {
    // as the system says, then
  }
  return matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}

export function store_theme(theme: Theme): void {
  try {
    localStorage.setItem(kKey, theme);
  } catch {
    // it lasts as long as the page, then
  }
}
