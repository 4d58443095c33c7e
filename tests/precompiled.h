// Precompiled for every test, as cmake/precompiled.h is for the program.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cmake/precompiled.h"
