"""The reproduction of the paper, on top of the library: figure groups, claims, report, stress trials."""
