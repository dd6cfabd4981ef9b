"""Pictures of results: charts and heat maps as data, SVG and PNG."""
