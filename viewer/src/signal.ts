// SPDX-License-Identifier: Apache-2.0
// Tells listeners that something changed.

export class Signal<T> {
  private listeners_ = new Set<(value: T) => void>();

  listen(listener: (value: T) => void): () => void {
    this.listeners_.add(listener);
    return () => this.listeners_.delete(listener);
  }

  emit(value: T): void {
    for (const listener of this.listeners_) listener(value);
  }
}
