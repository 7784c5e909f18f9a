"""Results that cannot be, made of ones that can."""

import xarray as xr


def spoil(data: xr.Dataset, name: str, value: float) -> xr.Dataset:
    """A copy in which the last entry of a variable has another value."""
    spoilt = data.copy(deep=True)
    spoilt[name].values.flat[-1] = value
    return spoilt
