// Columns of the data format and tables of the program, for tests.

/** Text of a table as columns of text. */
export function parse(text) {
  const [head, ...rows] = text.trim().split("\n").filter((line) => !line.startsWith("#")).map((line) => line.split(","));
  return Object.fromEntries(head.map((name, i) => [name, rows.map((row) => row[i])]));
}

/** A column of the page from numbers or their text, with as many decimals as given; what is no number is no value. */
export function column(values, decimals = 6) {
  const bytes = Buffer.alloc(values.length * 4);
  values.forEach((v, i) => bytes.writeInt32LE(v === "" || !Number.isFinite(Number(v)) ? -2147483648 : Math.round(Number(v) * 10 ** decimals), 4 * i));
  return { decimals, data: bytes.toString("base64") };
}

/** The numbers of a column of the page; NaN for no value. */
export function numbers({ decimals, offset = 0, data }) {
  const bytes = Buffer.from(data, "base64");
  return Array.from({ length: bytes.length / 4 }, (_, i) => {
    const bits = bytes.readInt32LE(4 * i);
    return bits === -2147483648 ? NaN : (offset + bits) / 10 ** decimals;
  });
}

/** A contour with every n-th of its samples: the same columns, sooner drawn. */
export function thinned(contour, n) {
  const of = (value) => {
    if (typeof value?.data !== "string") return value && typeof value === "object" && !Array.isArray(value) ? thinned(value, n) : value;
    const bytes = Buffer.from(value.data, "base64");
    const kept = Buffer.concat(Array.from({ length: Math.ceil(bytes.length / (4 * n)) }, (_, k) => bytes.subarray(4 * n * k, 4 * n * k + 4)));
    return { ...value, data: kept.toString("base64") };
  };
  return Object.fromEntries(Object.entries(contour).map(([name, value]) => [name, of(value)]));
}
