// Makes a page from its data. This is the only entry to the figures.
import type { PageData } from '../data';
import type { Page, Tab } from '../model';
import { make_compared_run_tabs } from './comparison_run';
import { make_compared_study_tabs } from './comparison_study';
import { make_reproduction_tabs } from './reproduction_page';
import { make_run_tabs } from './run_page';
import { make_study_tabs } from './study_page';
import { add_watched_items } from './watched';

function make_tabs(data: PageData, shown?: number[]): Tab[] {
  switch (data.kind) {
    case 'run':
      return make_run_tabs(data);
    case 'study':
      return make_study_tabs(data, shown);
    case 'reproduction':
      return make_reproduction_tabs(data);
    case 'comparison':
      return data.runs !== null
        ? make_compared_run_tabs(data, data.runs)
        : data.studies !== null
          ? make_compared_study_tabs(data, data.studies)
          : [];
  }
}

// `shown` are the optimizers of a comparison's figures and tables, by index; without it, all are shown.
export function make_page(data: PageData, shown?: number[]): Page {
  const [first, ...others] = make_tabs(data, shown);
  return { data, tabs: [{ ...first, items: add_watched_items(data, first.items) }, ...others] };
}
