"""From time records of a shaker bench to the first-order frequency response that `zspring identify` takes."""
