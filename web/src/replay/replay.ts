import type { Look } from '../charts/look';
import type { ReplaySet, Robot } from '../data';

export interface ReplayView {
  set_time(time_s: number): void;
  choose(set: string, case_id: string): void;
  set_look(look: Look): void;
  dispose(): void;
  readonly state: { set: string; case: string; time_s: number };
}

export function make_replay(
  host: HTMLElement,
  robots: Robot[],
  sets: ReplaySet[],
  _look: Look,
  _events: { on_time?(set: string, case_id: string, time_s: number): void },
): ReplayView {
  host.textContent = `${robots.length} robots, ${sets.length} sets`;
  return { set_time() {}, choose() {}, set_look() {}, dispose() {}, state: { set: '', case: '', time_s: 0 } };
}
