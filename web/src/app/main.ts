// The page's beginning: reads the data that stand in the document, or that the program serves while
// a study runs, and shows them.
import { kDark, kLight, type Look } from '../charts/look';
import type { PageData } from '../data';
import { make_page } from '../figures/page';
import '../replay/replay.css';
import './page.css';
import { follow } from './live';
import { make_page_view } from './page_view';
import { load_theme, store_theme, type Theme } from './theme';

function start(): void {
  const host = document.getElementById('page');
  const data = document.getElementById('data');
  if (host === null || data === null) {
    return;
  }
  let theme: Theme = load_theme();
  const get_look = (): Look => (theme === 'dark' ? kDark : kLight);
  const apply = (): void => document.documentElement.setAttribute('data-theme', theme);
  apply();
  const view = make_page_view(host, get_look(), () => {
    theme = theme === 'dark' ? 'light' : 'dark';
    store_theme(theme);
    apply();
    view.set_look(get_look());
  });
  view.show(make_page(JSON.parse(data.textContent ?? '') as PageData));
  if (document.documentElement.hasAttribute('data-live')) {
    follow((next) => view.show(make_page(next)));
  }
}

start();
