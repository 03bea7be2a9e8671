export type Theme = 'light' | 'dark';

const kKey = 'armwright-theme';

// A page opened from disk may have no storage.
export function load_theme(): Theme {
  try {
    const stored = localStorage.getItem(kKey);
    if (stored === 'light' || stored === 'dark') {
      return stored;
    }
  } catch {
    // then the theme of the system is used
  }
  return matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}

export function store_theme(theme: Theme): void {
  try {
    localStorage.setItem(kKey, theme);
  } catch {
    // then the choice lasts as long as the page is open
  }
}
