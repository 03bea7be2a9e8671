import type { Look } from '../charts/look';
import type { Item } from '../model';

// Something in the page that can be drawn anew: in another theme, with newer data.
export interface View {
  element: HTMLElement;
  set_look(look: Look): void;
  // Takes newer data of the same item, keeping what the reader has chosen; false if it cannot.
  update(item: Item): boolean;
  // Draws at once, where drawing waits for the layout.
  settle(): void;
  dispose(): void;
}
