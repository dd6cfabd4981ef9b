"""Pictures of results: charts and atlases as data, as SVG and as PNG."""
