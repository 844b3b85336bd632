// Job documents derived from another one: a copy, half the error, another viewpoint.

const named = (document, addition) => (document.name ? { name: `${document.name}${addition}`.slice(0, 100) } : {});

export const copyDocument = (document) => ({ ...document });

// Requests half the error of the result. The accuracy replaces numbers of photons and samples.
export function withHalfError(document, result) {
  const { photons, gather_samples: samples, pixel_samples: paths, accuracy, ...rest } = document;
  const found = result.cost.next.error;
  if (accuracy?.dgp_error) {
    const dgp_error = accuracy.dgp_error / 2;
    return { ...rest, ...named(document, ', half the error'), accuracy: { dgp_error } };
  }
  const relative_error = Number((found / 2).toPrecision(3));
  const at = accuracy?.at;
  const title = document.name?.replace(/, to [0-9.]+ %$/, '');
  return { ...rest, ...named({ name: title }, `, to ${Number((100 * relative_error).toPrecision(3))} %`), accuracy: { relative_error, ...(at ? { at } : {}) } };
}

// The first view from another viewpoint, without the sensors.
export function withViewpoint(document, name, view) {
  const { sensors, heat_map: map, views: [{ file, entry, ...first }], ...rest } = document;
  return { ...rest, ...named(document, `, ${name}`), views: [{ ...first, name, view }] };
}
