// The view of the whole page: the head, the tabs, and the open tab.
import type { Look } from '../charts/look';
import type { Fact, PageData } from '../data';
import { make_page } from '../figures/page';
import type { Item, Page, Tab } from '../model';
import { make_replay, type ReplayView } from '../replay/replay';
import { make_clock, make_time_key, type Clock } from './clock';
import { make, make_button } from './dom';
import { make_figure_view } from './figure_view';
import { make_files_view } from './files_view';
import { make_filter_view } from './filter_view';
import { make_progress_view } from './progress_view';
import { make_summary_view } from './summary_view';
import { make_table_view } from './table_view';
import { make_text } from './term_view';
import { make_text_view } from './text_view';
import type { View } from './view';

const kFewestToFilter = 3; // optimizers
const kLongFact = 100; // characters; a longer value has all columns of the list

function make_facts(facts: Fact[]): HTMLElement {
  const list = make('dl', { class: 'facts' });
  for (const fact of facts) {
    const shape = fact.value.length > kLongFact ? 'long' : 'short';
    list.append(make('div', { class: shape }, make('dt', {}, ...make_text(fact.label)), make('dd', {}, fact.value)));
  }
  return list;
}

function make_still(id: string, title: string, width: string, ...content: HTMLElement[]): View {
  const element = make('section', { class: 'card ' + width, id: 'figure-' + id, 'data-figure': id }, make('h3', {}, title), ...content);
  return { element, set_look() {}, update: () => false, settle() {}, dispose() {} };
}

function make_replay_view(id: string, title: string, page: Page, item: Item, look: Look, clock: Clock): View {
  const host = make('div', { class: 'replay' });
  const sets = item.kind === 'replay' ? item.sets : [];
  const replay: ReplayView = make_replay(host, page.data.robots, sets, look, {
    on_time: (set, case_id, time_s) => clock.set(set, case_id, time_s),
    on_point: (set, case_id, time_s) => clock.point(make_time_key(set, case_id), time_s),
  });
  const follow = (): void => {
    const state = replay.state;
    if (clock.replay !== state.set || clock.case_id !== state.case) {
      replay.choose(clock.replay, clock.case_id);
    }
    if (clock.replay === state.set && clock.case_id === state.case && Math.abs(clock.time_s - state.time_s) > 1e-9) {
      replay.set_time(clock.time_s);
    }
  };
  follow(); // the reader may return from another tab
  const stop = clock.listen((change) => {
    if (change === 'time') {
      follow();
    } else if (change === 'pointer') {
      const is_here = clock.pointer?.key === make_time_key(replay.state.set, replay.state.case);
      replay.set_pointer(is_here ? (clock.pointer?.at ?? null) : null);
    }
  });
  (window as unknown as { armwright_replay?: ReplayView }).armwright_replay = replay;
  return {
    element: make('section', { class: 'card full', id: 'figure-' + id, 'data-figure': id }, make('h3', {}, title), host),
    set_look: (next) => replay.set_look(next),
    update: () => true, // a recorded motion does not change
    settle() {},
    dispose: () => {
      stop();
      replay.dispose();
    },
  };
}

function make_view(page: Page, item: Item, look: Look, clock: Clock): View {
  switch (item.kind) {
    case 'figure':
      return make_figure_view(item, look, clock);
    case 'table':
      return make_table_view(item);
    case 'text':
      return make_text_view(item);
    case 'files':
      return make_files_view(item);
    case 'facts':
      return make_still(item.id, item.title, 'full', make_facts(item.facts));
    case 'summary':
      return make_summary_view(item);
    case 'replay':
      return make_replay_view(item.id, item.title, page, item, look, clock);
  }
}

export interface PageView {
  show(data: PageData): void;
  set_look(look: Look): void;
}

export interface PageEvents {
  toggle_theme(): void;
  // A printed page is light, whatever the theme on the screen.
  on_print(begins: boolean): void;
}

export function make_page_view(host: HTMLElement, first_look: Look, events: PageEvents): PageView {
  const clock = make_clock();
  let look = first_look;
  let page: Page | null = null;
  let shown_data: PageData | null = null;
  let views: View[] = [];
  let contents: string[] = []; // that the views show
  let figures_key = ''; // the data and the filter, from which figures are drawn
  let figures_version = 0; // counts the changes of figures_key
  let open = '';

  const title = make('h1');
  const subtitle = make('p', { class: 'subtitle' });
  const state = make('p', { class: 'state', role: 'status' });
  const progress = make_progress_view();
  const notes = make('ul', { class: 'notes' });
  const filter = make_filter_view(() => {
    if (shown_data !== null) {
      show(shown_data);
    }
  });
  const list = make('div', { role: 'tablist', 'aria-label': 'Sections' });
  const panel = make('div', { role: 'tabpanel', id: 'panel', tabindex: '0' });
  const foot = make('footer');
  // The address after # names the open tab, so the link moves the focus itself.
  const skip = make('a', { class: 'skip', href: '#panel' }, 'To the contents');
  skip.addEventListener('click', (event) => {
    event.preventDefault();
    panel.focus();
  });
  host.append(
    skip,
    make(
      'header',
      {},
      make('div', { class: 'titles' }, title, subtitle, state),
      make_button('Light / dark', events.toggle_theme, { class: 'theme', 'aria-label': 'Light / dark' }),
    ),
    make('main', {}, progress.element, notes, filter.element, list, panel),
    foot,
  );

  function close(): void {
    views.forEach((view) => view.dispose());
    views = [];
    contents = [];
    panel.replaceChildren();
  }

  // The content of an item, as a text that can be compared. Figures are functions: they draw the
  // same as long as the data and the filter are the same.
  function describe_content(item: Item): string {
    if (item.kind === 'replay') {
      return ''; // a recorded motion does not change
    }
    return JSON.stringify(item) + (item.kind === 'figure' ? figures_version : '');
  }

  // An item with the same content is not touched, so that its scroll position, the keyboard's focus
  // and the rows that the reader asked for stay.
  function update_or_replace(item: Item, index: number): void {
    const content = describe_content(item);
    if (page === null || contents[index] === content) {
      return;
    }
    contents[index] = content;
    if (!views[index].update(item)) {
      const newer = make_view(page, item, look, clock);
      views[index].element.replaceWith(newer.element);
      views[index].dispose();
      views[index] = newer;
    }
  }

  // Puts newer data of the same tab into the existing views. Returns false if the tab has other
  // items now.
  function update_items(tab: Tab): boolean {
    const same = tab.items.length === views.length && tab.items.every((item, i) => views[i].element.dataset.figure === item.id);
    if (same) {
      tab.items.forEach(update_or_replace);
    }
    return same;
  }

  function append_items(tab: Tab): void {
    if (page === null) {
      return;
    }
    const grid = make('div', { class: 'cards' });
    panel.append(make('h2', {}, tab.title), grid);
    for (const item of tab.items) {
      const view = make_view(page, item, look, clock);
      views.push(view);
      contents.push(describe_content(item));
      grid.append(view.element);
    }
  }

  function choose(id: string, focus: boolean): void {
    const tab = page?.tabs.find((one) => one.id === id) ?? page?.tabs[0];
    if (tab === undefined) {
      return;
    }
    close();
    open = tab.id;
    list.querySelectorAll<HTMLElement>('[role=tab]').forEach((button) => {
      const chosen = button.dataset.tab === open;
      button.setAttribute('aria-selected', String(chosen));
      button.tabIndex = chosen ? 0 : -1;
      if (chosen) {
        panel.setAttribute('aria-labelledby', button.id);
        if (focus) {
          button.focus();
        }
      }
    });
    append_items(tab);
  }

  function same_tabs(tabs: Tab[]): boolean {
    const there = Array.from(list.querySelectorAll<HTMLElement>('[role=tab]'));
    return there.length === tabs.length && tabs.every((tab, i) => there[i].dataset.tab === tab.id && there[i].textContent === tab.title);
  }

  function make_tab_button(tab: Tab): HTMLButtonElement {
    return make_button(
      tab.title,
      () => {
        choose(tab.id, false);
        history.replaceState(null, '', '#' + encodeURIComponent(tab.id));
      },
      { role: 'tab', id: 'tab-' + tab.id, 'data-tab': tab.id, 'aria-controls': panel.id },
    );
  }

  list.addEventListener('keydown', (event) => {
    const ids = page?.tabs.map((tab) => tab.id) ?? [];
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const next =
      step !== undefined
        ? (ids.indexOf(open) + step + ids.length) % ids.length
        : event.key === 'Home'
          ? 0
          : event.key === 'End'
            ? ids.length - 1
            : -1;
    if (next >= 0) {
      event.preventDefault();
      choose(ids[next], true);
    }
  });

  // A printed page shows all tabs one after the other. After printing, the open tab is shown again.
  window.addEventListener('beforeprint', () => {
    close();
    events.on_print(true);
    page?.tabs.forEach((tab) => {
      append_items({ ...tab, items: tab.items.filter((item) => item.kind !== 'replay') });
    });
    views.forEach((view) => view.settle());
  });
  window.addEventListener('afterprint', () => {
    events.on_print(false);
    choose(open, false);
  });
  window.addEventListener('hashchange', () => choose(decodeURIComponent(location.hash.slice(1)), false));

  function show(data: PageData): void {
    shown_data = data;
    filter.element.hidden = data.kind !== 'study' || data.optimizers.length < kFewestToFilter;
    const filtered = data.kind === 'study' ? filter.apply(data) : undefined;
    const next = make_page(data, filtered);
    // The data of a page that is not watched do not change.
    const key = JSON.stringify([data.watched === null ? null : { ...data, progress: null, watched: null }, filtered]);
    figures_version += key === figures_key ? 0 : 1;
    figures_key = key;
    page = next;
    document.title = data.title;
    title.textContent = data.title;
    subtitle.textContent = data.subtitle;
    state.textContent = data.watched !== null && data.finished ? 'Finished' : '';
    progress.show(data);
    notes.replaceChildren(...data.notes.map((note) => make('li', {}, note)));
    const shown = next.tabs.find((tab) => tab.id === open);
    foot.replaceChildren(
      make('p', {}, `armwright ${data.program.version} (${data.program.commit}). Made by `, make('code', {}, data.command)),
      make('p', {}, 'Folder: ', make('code', {}, data.folder)),
    );
    if (shown === undefined || !same_tabs(next.tabs) || !update_items(shown)) {
      list.replaceChildren(...next.tabs.map(make_tab_button));
      choose(open || decodeURIComponent(location.hash.slice(1)), false);
    }
  }

  return {
    show,
    set_look(next: Look) {
      look = next;
      views.forEach((view) => view.set_look(next));
    },
  };
}
