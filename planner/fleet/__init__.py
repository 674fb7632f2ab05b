"""Several aircraft: who does what, when; knows neither sensors nor the scenario."""
