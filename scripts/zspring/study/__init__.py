"""Parameter studies: many cases on local processes or a Dask cluster."""
