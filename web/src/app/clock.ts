// What the plots over one abscissa share: the time of the replay, the place of the pointer, and the
// part that the reader has zoomed into. A key names the abscissa: plots with the same key share all.
import type { Range } from '../charts/zoom';

export type Change = 'time' | 'pointer' | 'zoom';

export interface Clock {
  readonly replay: string;
  readonly case_id: string;
  readonly time_s: number;
  set(replay: string, case_id: string, time_s: number): void;
  readonly pointer: { key: string; at: number } | null;
  point(key: string, at: number | null): void; // null: the pointer has left the plots with this key
  zoom_of(key: string): Range | null; // null: the plots show everything
  zoom(key: string, range: Range | null): void;
  listen(on_change: (change: Change) => void): () => void; // returns the function that removes the listener
}

// Returns the key of the time of a replay's case.
export function make_time_key(replay: string, case_id: string): string {
  return `time ${replay} ${case_id}`;
}

export function make_clock(): Clock {
  const listeners: ((change: Change) => void)[] = [];
  const zooms = new Map<string, Range>();
  const tell = (change: Change): void => listeners.slice().forEach((listener) => listener(change));
  const clock = {
    replay: '',
    case_id: '',
    time_s: 0,
    pointer: null as Clock['pointer'],
    set(replay: string, case_id: string, time_s: number) {
      if (replay === clock.replay && case_id === clock.case_id && time_s === clock.time_s) {
        return;
      }
      clock.replay = replay;
      clock.case_id = case_id;
      clock.time_s = time_s;
      tell('time');
    },
    point(key: string, at: number | null) {
      if (at === null ? clock.pointer?.key !== key : clock.pointer?.key === key && clock.pointer.at === at) {
        return;
      }
      clock.pointer = at === null ? null : { key, at };
      tell('pointer');
    },
    zoom_of: (key: string) => zooms.get(key) ?? null,
    zoom(key: string, range: Range | null) {
      if (range !== null) {
        zooms.set(key, range);
        tell('zoom');
      } else if (zooms.delete(key)) {
        tell('zoom');
      }
    },
    listen(on_change: (change: Change) => void) {
      listeners.push(on_change);
      return () => {
        listeners.splice(listeners.indexOf(on_change), 1);
      };
    },
  };
  return clock;
}
