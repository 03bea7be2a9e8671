// The moment that the replay and the plots over time show together.
export interface Clock {
  readonly replay: string;
  readonly case_id: string;
  readonly time_s: number;
  set(replay: string, case_id: string, time_s: number): void;
  listen(on_change: () => void): () => void; // returns the function that removes the listener
}

export function make_clock(): Clock {
  const listeners: (() => void)[] = [];
  const clock = {
    replay: '',
    case_id: '',
    time_s: 0,
    set(replay: string, case_id: string, time_s: number) {
      if (replay === clock.replay && case_id === clock.case_id && time_s === clock.time_s) {
        return;
      }
      clock.replay = replay;
      clock.case_id = case_id;
      clock.time_s = time_s;
      listeners.slice().forEach((listener) => listener());
    },
    listen(on_change: () => void) {
      listeners.push(on_change);
      return () => {
        listeners.splice(listeners.indexOf(on_change), 1);
      };
    },
  };
  return clock;
}
