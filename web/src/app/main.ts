// The entry point of the page. It reads the data in the document, or those that the program serves
// while a study runs, and shows them.
import { kDark, kLight, type Look } from '../charts/look';
import type { PageData } from '../data';
import '../replay/replay.css';
import './page.css';
import './summary.css';
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
  let on_paper = false;
  const apply = (): Look => {
    const shown = on_paper ? 'light' : theme;
    document.documentElement.setAttribute('data-theme', shown);
    return shown === 'dark' ? kDark : kLight;
  };
  const view = make_page_view(host, apply(), {
    toggle_theme() {
      theme = theme === 'dark' ? 'light' : 'dark';
      store_theme(theme);
      view.set_look(apply());
    },
    on_print(begins) {
      on_paper = begins;
      view.set_look(apply());
    },
  });
  const first = JSON.parse(data.textContent ?? '') as PageData;
  view.show(first);
  if (document.documentElement.hasAttribute('data-live')) {
    follow(first.finished, (next) => view.show(next));
  }
}

start();
