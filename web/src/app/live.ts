// While a study runs, its page asks for newer data every few seconds. The server answers 304 if
// nothing has changed.
import type { PageData } from '../data';

const kPeriod_ms = 2000;

// Stops once the data are finished; `finished` says whether those in the page are.
export function follow(finished: boolean, on_data: (data: PageData) => void): void {
  const root = document.documentElement;
  let tag = root.getAttribute('data-live') ?? '';
  async function ask(): Promise<void> {
    try {
      const answer = await fetch('data.json', { headers: { 'If-None-Match': tag }, cache: 'no-store' });
      if (answer.status === 200) {
        const data = (await answer.json()) as PageData;
        tag = answer.headers.get('ETag') ?? tag;
        on_data(data);
        finished = data.finished;
      }
      root.setAttribute('data-connection', finished ? 'finished' : 'live');
    } catch {
      root.setAttribute('data-connection', 'lost'); // the page keeps its content and asks again
    }
    if (!finished) {
      setTimeout(() => void ask(), kPeriod_ms);
    }
  }
  if (finished) {
    root.setAttribute('data-connection', 'finished');
  } else {
    setTimeout(() => void ask(), kPeriod_ms);
  }
}
