"""Figure group ``polydisperse_averages``."""
