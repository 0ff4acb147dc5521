#include "drivers/files/journal.hpp"
#include "drivers/iio/iio_session.hpp"
