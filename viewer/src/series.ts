// The rows that came with the frames, per swatch, for the curves and the table. Bounded: when there are too many, every
// second row goes.
export class Series {
  rows: Float64Array[] = [];
  private stride = 1;
  private skipped = 0;

  // `whole`: of a finished run, which is all there; frames add nothing.
  constructor(readonly columns: string[], private readonly most = 4000) {}
  whole = false;

  load(history: (number | null)[][], whole = false): void {
    this.rows = history.map((row) => Float64Array.from(row, (x) => x ?? Number.NaN));
    this.whole = whole && history.length > 0;
    this.stride = 1;
  }

  add(values: Float64Array): void {
    if (this.whole) return;
    const last = this.rows[this.rows.length - 1];
    if (last && values[0]! < last[0]!) this.rows = this.rows.filter((row) => row[0]! <= values[0]!);  // a replay went back
    if (last && values[0]! === last[0]!) { this.rows[this.rows.length - 1] = values; return; }
    if (++this.skipped < this.stride) return;
    this.skipped = 0;
    this.rows.push(values);
    if (this.rows.length < this.most) return;
    this.rows = this.rows.filter((_, i) => i % 2 === 0);
    this.stride *= 2;
  }

  index(name: string): number { return this.columns.indexOf(name); }
  column(name: string, factor = 1): number[] {
    const i = this.index(name);
    return this.rows.map((row) => row[i]! * factor);
  }
  last(name: string): number { return this.rows[this.rows.length - 1]?.[this.index(name)] ?? 0; }

  csv(): string {
    const lines = this.rows.map((row) => Array.from(row, (x) => (Number.isFinite(x) ? String(x) : '')).join(','));
    return [this.columns.join(','), ...lines].join('\n') + '\n';
  }
}
