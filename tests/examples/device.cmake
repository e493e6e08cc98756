# On the first device that OpenCL has; pocl's is this processor.
find_package(OpenCL QUIET)
if(OpenCL_FOUND)
    example_folder(device)
    foreach(precision single mixed double)
        add_test(NAME examples.device.${precision} COMMAND ${CMAKE_CURRENT_BINARY_DIR}/device/device_steps ${precision})
        set_tests_properties(examples.device.${precision} PROPERTIES
            FIXTURES_REQUIRED examples_device TIMEOUT 300 SKIP_RETURN_CODE 77)
    endforeach()
else()
    left_out_test(examples.device "no OpenCL to build with (Debian: ocl-icd-opencl-dev, and pocl-opencl-icd for a device)")
endif()
