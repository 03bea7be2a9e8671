import type { Look } from '../charts/look';
import type { Item } from '../model';

// A part of the page that can be drawn again with another theme or with newer data.
export interface View {
  element: HTMLElement;
  set_look(look: Look): void;
  // Takes newer data of the same item and keeps the reader's choices. Returns false if it cannot.
  update(item: Item): boolean;
  // Draws at once, even if the view normally waits for the layout.
  settle(): void;
  dispose(): void;
}
