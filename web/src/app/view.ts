import type { Look } from '../charts/look';

// Something in the page that can be drawn anew in another theme.
export interface View {
  element: HTMLElement;
  set_look(look: Look): void;
  dispose(): void;
}
